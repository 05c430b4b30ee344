"""What the commands do with a key file: keys are stored, chosen, removed, listed, and shown on request."""

from __future__ import annotations

import io
import sys
from pathlib import Path

import pytest

from link.signing.key_actions import (
    KeyActionError,
    ShownAs,
    find_key,
    format_list,
    format_secret,
    install_key,
    make_key,
    pick_key,
    remove_key,
    store_key,
    use_key,
)
from link.signing.key_file import load_keys
from link.signing.key_qr import draw_qr
from link.signing.keys import KeyRing, SigningKey, new_key
from link.signing.role import SigningRole

SECRET = bytes(range(32))
LAPTOP = SigningKey("laptop", SigningRole.DRIVE, SECRET)


class Screen(io.StringIO):
    """Standard output as a terminal with an encoding."""

    def __init__(self, encoding: str | None) -> None:
        super().__init__()
        self._encoding = encoding

    @property
    def encoding(self) -> str | None:  # type: ignore[override]
        return self._encoding

    def isatty(self) -> bool:
        return True


@pytest.fixture
def path(tmp_path: Path) -> Path:
    return tmp_path / "keys.toml"


def error_of(path: Path, name: str | None) -> str:
    with pytest.raises(KeyActionError) as caught:
        find_key(path, name)
    return str(caught.value)


def test_each_way_to_add_a_key_stores_and_returns_it(path: Path) -> None:
    made = make_key(path, "made", SigningRole.WATCH)
    installed = install_key(path, "installed", SigningRole.SET_UP, SECRET)
    stored = store_key(path, new_key("stored", SigningRole.DRIVE))
    assert (made.name, made.role, len(made.secret)) == ("made", SigningRole.WATCH, 32)
    assert (installed.name, installed.role, installed.secret) == ("installed", SigningRole.SET_UP, SECRET)
    assert load_keys(path).keys == (made, installed, stored)


def test_a_key_that_cannot_be_added_changes_nothing(path: Path) -> None:
    store_key(path, LAPTOP)
    with pytest.raises(KeyActionError, match="there is a key laptop already"):
        make_key(path, "laptop", SigningRole.WATCH)
    with pytest.raises(KeyActionError, match="this secret is there already, as laptop"):
        install_key(path, "tablet", SigningRole.WATCH, SECRET)
    with pytest.raises(KeyActionError, match="a key's name is 1 to 24 letters"):
        make_key(path, "a b", SigningRole.WATCH)
    with pytest.raises(KeyActionError, match="this one has 3"):
        install_key(path, "tablet", SigningRole.WATCH, b"abc")
    assert load_keys(path).keys == (LAPTOP,)


def test_a_key_is_found_by_name_by_fingerprint_or_alone(path: Path) -> None:
    assert error_of(path, None) == error_of(path, "laptop") == "there are no keys"
    store_key(path, LAPTOP)
    assert find_key(path, None) == LAPTOP
    assert find_key(path, "laptop") == LAPTOP
    assert error_of(path, "desk") == "there is no key 'desk'; there are laptop"
    tablet = make_key(path, "tablet", SigningRole.WATCH)
    assert find_key(path, tablet.fingerprint.upper()) == tablet
    assert find_key(path, "laptop") == LAPTOP
    assert error_of(path, None) == "name a key: laptop, tablet"
    assert error_of(path, "desk") == "there is no key 'desk'; there are laptop, tablet"
    assert pick_key(KeyRing((LAPTOP, tablet)), "tablet") == tablet


def test_the_named_key_signs_and_the_named_key_goes(path: Path) -> None:
    store_key(path, LAPTOP)
    tablet = make_key(path, "tablet", SigningRole.WATCH)
    assert load_keys(path).sign_with == "laptop"
    assert use_key(path, tablet.fingerprint) == tablet
    assert load_keys(path).sign_with == "tablet"
    assert remove_key(path, LAPTOP.fingerprint) == LAPTOP
    assert load_keys(path) == KeyRing((tablet,), "tablet")
    with pytest.raises(KeyActionError, match="there is no key 'laptop'"):
        remove_key(path, "laptop")


def test_a_list_marks_the_key_that_signs(path: Path) -> None:
    tablet = SigningKey("tablet", SigningRole.SET_UP, b"\x01" * 32)
    ring = KeyRing((LAPTOP, tablet), "tablet")
    first, second = LAPTOP.fingerprint, tablet.fingerprint
    assert list(format_list(ring, roles=False)) == [
        f"  laptop                    {first}",
        f"> tablet                    {second}",
    ]
    assert list(format_list(ring, roles=True)) == [
        f"  laptop                    drive  {first}",
        f"> tablet                    setup  {second}",
    ]


def test_a_secret_is_shown_as_hex_and_as_lines_of_six_words() -> None:
    pytest.importorskip("mnemonic")
    assert format_secret(LAPTOP, ShownAs.HEX) == f"{SECRET.hex()}\n"
    words = format_secret(LAPTOP, ShownAs.WORDS)
    assert words.endswith("\n")
    lines = [line.split(" ") for line in words.splitlines()]
    assert [len(line) for line in lines] == [6, 6, 6, 6]
    assert lines[0] == ["abandon", "amount", "liar", "amount", "expire", "adjust"]
    assert lines[3][-1] == "unaware"


@pytest.mark.parametrize(
    ("encoding", "unicode"), [("utf-8", True), ("UTF8", True), ("ISO-8859-1", False), (None, False)]
)
def test_a_qr_code_is_drawn_as_the_terminal_can(
    encoding: str | None, unicode: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    pytest.importorskip("segno")
    monkeypatch.setattr(sys, "stdout", Screen(encoding))
    assert format_secret(LAPTOP, ShownAs.QR) == draw_qr(SECRET.hex().upper(), unicode=unicode)


def test_a_qr_code_goes_to_a_terminal_only(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "stdout", io.StringIO())
    with pytest.raises(KeyActionError, match="a QR code is for a terminal; --hex and --words go to files and pipes"):
        format_secret(LAPTOP, ShownAs.QR)


def test_a_mistake_of_a_key_is_not_chained_to_the_secret(path: Path) -> None:
    with pytest.raises(KeyActionError) as caught:
        install_key(path, "a b", SigningRole.WATCH, SECRET)
    assert caught.value.__cause__ is None
    assert caught.value.__suppress_context__
