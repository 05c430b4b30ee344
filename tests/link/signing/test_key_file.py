"""Key files: private, whole, and one clear line for each mistake in them."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from link.signing.key_file import KeyFileError, change_keys, load_keys, save_keys
from link.signing.keys import KeyRing, new_key
from link.signing.role import Role

SECRET = "ab" * 32


def write(path: Path, text: str, mode: int = 0o600) -> Path:
    path.write_text(text)
    path.chmod(mode)
    return path


def key(name: str = "laptop", role: str = "drive", secret: str = SECRET, more: str = "") -> str:
    return f'[[key]]\nname = "{name}"\nrole = "{role}"\nsecret = "{secret}"\n{more}'


def problem(path: Path) -> str:
    with pytest.raises(KeyFileError) as caught:
        load_keys(path)
    text = str(caught.value)
    assert "\n" not in text
    assert str(path) in text
    assert SECRET[:16] not in text
    return text


def test_keys_come_back_as_they_were_saved(tmp_path: Path) -> None:
    ring = KeyRing().add(new_key("laptop", Role.SET_UP)).add(new_key("tablet", Role.WATCH), sign=True)
    path = tmp_path / "new" / "keys.toml"
    save_keys(path, ring)
    assert load_keys(path) == ring
    assert path.stat().st_mode & 0o777 == 0o600
    assert path.parent.stat().st_mode & 0o777 == 0o700
    assert os.listdir(path.parent) == ["keys.toml"]


def test_an_empty_ring_is_saved_and_no_file_is_an_empty_ring(tmp_path: Path) -> None:
    path = tmp_path / "keys.toml"
    assert load_keys(path) == KeyRing()
    save_keys(path, KeyRing())
    assert load_keys(path) == KeyRing()


def test_a_file_is_private_whatever_the_umask(tmp_path: Path) -> None:
    before = os.umask(0)
    try:
        save_keys(tmp_path / "keys.toml", KeyRing().add(new_key("a", Role.WATCH)))
    finally:
        os.umask(before)
    assert (tmp_path / "keys.toml").stat().st_mode & 0o777 == 0o600


@pytest.mark.parametrize("mode", [0o640, 0o604, 0o620, 0o602, 0o610])
def test_a_file_that_others_can_read_or_write_is_refused(tmp_path: Path, mode: int) -> None:
    path = write(tmp_path / "keys.toml", key(), mode)
    assert problem(path).endswith(f"chmod 600 {path}")


def test_a_link_a_folder_a_pipe_and_a_large_file_are_refused(tmp_path: Path) -> None:
    link = tmp_path / "link.toml"
    link.symlink_to(write(tmp_path / "keys.toml", key()))
    assert "symbolic link" in problem(link)
    assert "regular file" in problem(tmp_path)
    os.mkfifo(tmp_path / "pipe", 0o600)
    assert "regular file" in problem(tmp_path / "pipe")
    assert "larger than" in problem(write(tmp_path / "large", "#" * 70_000))


@pytest.mark.skipif(os.geteuid() != 0, reason="only root gives files away")
def test_a_file_of_another_user_is_refused_and_root_keeps_owners(tmp_path: Path) -> None:
    path = write(tmp_path / "keys.toml", key())
    os.chown(path, 4242, -1)
    assert "belongs to user 4242" in problem(path)
    os.chown(tmp_path, 4242, -1)
    assert load_keys(path).find("laptop") is not None
    save_keys(tmp_path / "new.toml", KeyRing().add(new_key("a", Role.WATCH)))
    assert (tmp_path / "new.toml").stat().st_uid == 4242


@pytest.mark.skipif(os.geteuid() != 0, reason="only root gives files away")
def test_root_gives_away_no_file_that_another_user_has_linked(tmp_path: Path) -> None:
    (tmp_path / "secret").touch()
    folder = tmp_path / "state"
    folder.mkdir()
    os.chown(folder, 4242, -1)
    os.link(tmp_path / "secret", folder / ".keys.toml.lock")
    change_keys(folder / "keys.toml", lambda ring: ring.add(new_key("a", Role.WATCH)))
    assert (tmp_path / "secret").stat().st_uid == 0
    assert (folder / "keys.toml").stat().st_uid == 4242


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        (key(secret=SECRET[:-2]), "key[0] 'laptop': a secret is 64 hex digits, this one has 62 characters"),
        (key(secret=SECRET[:-1] + "g"), "key[0] 'laptop': a secret is 64 hex digits, this one has other characters"),
        (key(secret="00" * 32), "key[0] 'laptop': 32 zero bytes are not a key"),
        (key(role="admin"), "key[0] 'laptop': role 'admin' is not known; there are watch, drive, setup"),
        (key(name="a b"), "key[0] 'a b': a key's name is 1 to 24 letters"),
        (key() + key(secret="cd" * 32), "key[1] 'laptop': there is a key laptop already"),
        (key() + key("tablet"), "key[1] 'tablet': this secret is there already, as laptop"),
        (key(more='rolle = "x"\n'), "key[0].rolle: unknown key"),
        ('sign_with = "desk"\n' + key(), "sign_with: there is no key 'desk'"),
        ("secret = 1\n", "secret: unknown key"),
        ('[[key]]\nname = "a"\n', "missing"),
        ("[[key]\n", "line 1"),
    ],
)  # fmt: skip
def test_a_mistake_is_one_line_with_file_key_and_remedy(tmp_path: Path, text: str, expected: str) -> None:
    path = write(tmp_path / "keys.toml", text)
    assert expected in problem(path)
    assert problem(path).endswith("correct it, or remove the file and pair again")


def test_bytes_that_are_no_text_are_refused(tmp_path: Path) -> None:
    path = tmp_path / "keys.toml"
    path.write_bytes(b"\xff\xfe")
    path.chmod(0o600)
    assert "not UTF-8" in problem(path)


def test_a_folder_that_cannot_be_written_is_one_line(tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    with pytest.raises(KeyFileError, match="no key was changed"):
        save_keys(tmp_path / "file" / "keys.toml", KeyRing())
