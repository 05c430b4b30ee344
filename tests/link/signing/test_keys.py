"""Keys of MAVLink signing: what they are made of, and that no text form of them contains the secret."""

from __future__ import annotations

import copy
import hashlib
import pickle

import pytest

from link.signing.keys import MAX_KEYS, KeyRing, PassphraseKind, SigningKey, key_from_passphrase, new_key
from link.signing.role import SigningRole

SECRET = bytes(range(1, 33))
KEY = SigningKey("laptop", SigningRole.DRIVE, SECRET)


def test_no_text_form_contains_the_secret() -> None:
    for text in (repr(KEY), str(KEY), f"{KEY}", repr(KeyRing().add(KEY)), KEY.fingerprint):
        assert SECRET.hex() not in text
        assert repr(SECRET) not in text
    assert str(KEY) == f"laptop (drive, {KEY.fingerprint})"


@pytest.mark.parametrize("leak", [pickle.dumps, copy.copy, copy.deepcopy])
def test_a_key_is_neither_pickled_nor_copied(leak: object) -> None:
    with pytest.raises(TypeError, match="neither pickled nor copied"):
        leak(KEY)  # type: ignore[operator]


def test_fingerprint_is_stable_and_not_the_hash_of_the_secret() -> None:
    assert KEY.fingerprint == "d5669a9a"
    assert not hashlib.sha256(SECRET).hexdigest().startswith(KEY.fingerprint)
    assert SigningKey("other", SigningRole.WATCH, SECRET).fingerprint == KEY.fingerprint


def test_new_keys_differ() -> None:
    first, second = new_key("a", SigningRole.SET_UP), new_key("b", SigningRole.SET_UP)
    assert len(first.secret) == 32
    assert first.secret != second.secret


@pytest.mark.parametrize(
    ("name", "secret", "problem"),
    [
        ("", SECRET, "name"), ("-a", SECRET, "name"), ("a b", SECRET, "name"), ("a\x1b[2J", SECRET, "name"),
        ("a" * 25, SECRET, "name"), ("a", SECRET[:-1], "this one has 31"), ("a", bytes(32), "zero"),
    ],
)  # fmt: skip
def test_what_is_no_key_is_refused(name: str, secret: bytes, problem: str) -> None:
    with pytest.raises(ValueError, match=problem):
        SigningKey(name, SigningRole.WATCH, secret)


def test_roles_include_each_other() -> None:
    assert SigningRole.WATCH < SigningRole.DRIVE < SigningRole.SET_UP
    assert [role.word for role in SigningRole] == ["watch", "drive", "setup"]


def test_a_passphrase_gives_the_key_of_mavproxy_and_old_qgc() -> None:
    # MAVProxy: hashlib.new("sha256"), update(passphrase). QGroundControl 5.0: QCryptographicHash::hash(utf8, Sha256).
    # printf secret_key | sha256sum
    expected = "6523e58bc0eec42c31b9635d5e0dfc23b6d119b73e633bf3a5284c79bb4a1ede"
    assert key_from_passphrase("secret_key").hex() == expected
    assert key_from_passphrase("Schlüssel") == hashlib.sha256("Schlüssel".encode()).digest()


def test_a_passphrase_gives_the_key_of_newer_qgroundcontrol() -> None:
    # QPasswordDigestor::deriveKeyPbkdf2(Sha256, utf8, "QGroundControl-MAVLink-Signing-v1", 600000, 32)
    # and `openssl kdf`
    expected = "1662b6ca0890938fad1d61ffdd37b3615e3f1b3f37b15f23962dc0b393c881e7"
    assert key_from_passphrase("correct horse", PassphraseKind.PBKDF2).hex() == expected


def test_the_first_key_signs_until_another_is_chosen() -> None:
    ring = KeyRing().add(KEY)
    assert ring.signing_key is KEY
    tablet = new_key("tablet", SigningRole.WATCH)
    ring = ring.add(tablet)
    assert ring.signing_key is KEY
    assert ring.choose("tablet").signing_key is tablet
    assert ring.add(new_key("desk", SigningRole.DRIVE), sign=True).sign_with == "desk"
    assert ring.find_fingerprint(tablet.fingerprint.upper()) is tablet


def test_after_the_removal_of_the_key_that_signs_the_newest_does() -> None:
    tablet = new_key("tablet", SigningRole.WATCH)
    ring = KeyRing().add(KEY).add(tablet)
    assert ring.remove("laptop") == KeyRing((tablet,), "tablet")
    assert ring.remove("tablet") == KeyRing((KEY,), "laptop")
    assert ring.remove("laptop").remove("tablet") == KeyRing()


def test_a_name_or_secret_is_in_a_ring_once_and_there_is_a_limit() -> None:
    ring = KeyRing().add(KEY)
    assert "already" in (ring.refuse(new_key("laptop", SigningRole.WATCH)) or "")
    assert ring.refuse(SigningKey("copy", SigningRole.WATCH, SECRET)) == "this secret is there already, as laptop"
    for number in range(MAX_KEYS - 1):
        ring = ring.add(new_key(f"k{number}", SigningRole.WATCH))
    with pytest.raises(ValueError, match="remove one first"):
        ring.add(new_key("more", SigningRole.WATCH))
    with pytest.raises(ValueError, match="no key none"):
        ring.choose("none")


def test_the_newest_of_the_keys_that_are_left_signs() -> None:
    ring = KeyRing()
    for name in ("one", "two", "three"):
        ring = ring.add(new_key(name, SigningRole.DRIVE), sign=True)
    assert ring.remove("three").sign_with == "two"
    assert ring.remove("one").sign_with == "three"


def test_roles_rise_from_1() -> None:
    assert [int(role) for role in SigningRole] == [1, 2, 3]
