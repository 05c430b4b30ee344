"""Key files: private, whole, and one clear line for each mistake in them."""

from __future__ import annotations

import fcntl
import os
import resource
from pathlib import Path

import pytest

from link.signing.key_file import (
    KeyFileError,
    change_keys,
    format_keys,
    load_keys,
    save_keys,
    station_key_file,
)
from link.signing.keys import KeyRing, SigningKey, new_key
from link.signing.role import SigningRole

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
    ring = KeyRing().add(new_key("laptop", SigningRole.SET_UP)).add(new_key("tablet", SigningRole.WATCH), sign=True)
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
        save_keys(tmp_path / "keys.toml", KeyRing().add(new_key("a", SigningRole.WATCH)))
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
    save_keys(tmp_path / "new.toml", KeyRing().add(new_key("a", SigningRole.WATCH)))
    assert (tmp_path / "new.toml").stat().st_uid == 4242


@pytest.mark.skipif(os.geteuid() != 0, reason="only root gives files away")
def test_root_gives_away_no_file_that_another_user_has_linked(tmp_path: Path) -> None:
    (tmp_path / "secret").touch()
    folder = tmp_path / "state"
    folder.mkdir()
    os.chown(folder, 4242, -1)
    os.link(tmp_path / "secret", folder / ".keys.toml.lock")
    change_keys(folder / "keys.toml", lambda ring: ring.add(new_key("a", SigningRole.WATCH)))
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


def test_the_text_of_a_file_names_the_key_that_signs() -> None:
    ring = KeyRing().add(SigningKey("laptop", SigningRole.SET_UP, bytes.fromhex(SECRET)))
    head, _, text = format_keys(ring).partition("\n")
    assert (
        head
        == "# Keys for MAVLink signing, written by mavhelm. Who can read this file can do all that these keys may do."
    )
    assert text == f'sign_with = "laptop"\n\n[[key]]\nname = "laptop"\nrole = "setup"\nsecret = "{SECRET}"\n'
    assert format_keys(KeyRing()) == f"{head}\n"


def test_the_file_of_a_user_is_in_the_config_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path))
    assert station_key_file() == tmp_path / "mavhelm/keys.toml"


def test_new_folders_are_private_and_nothing_is_left_open(tmp_path: Path) -> None:
    opened = len(os.listdir("/proc/self/fd"))
    save_keys(tmp_path / "a/b/keys.toml", KeyRing())
    change_keys(tmp_path / "c/d/keys.toml", lambda ring: ring.add(new_key("a", SigningRole.WATCH)))
    assert load_keys(tmp_path / "c/d/keys.toml").find("a") is not None
    assert [path.stat().st_mode & 0o777 for path in (tmp_path / "a/b", tmp_path / "c/d")] == [0o700, 0o700]
    assert (tmp_path / "c/d/.keys.toml.lock").stat().st_mode & 0o777 == 0o600
    assert len(os.listdir("/proc/self/fd")) == opened


def test_a_change_returns_and_writes_the_keys_under_a_lock(tmp_path: Path) -> None:
    path = tmp_path / "keys.toml"
    lock = path.with_name(".keys.toml.lock")

    def change(ring: KeyRing) -> KeyRing:
        descriptor = os.open(lock, os.O_RDWR)
        try:
            with pytest.raises(BlockingIOError):
                fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
        finally:
            os.close(descriptor)
        return ring.add(new_key("a", SigningRole.WATCH))

    after = change_keys(path, change)
    assert [key.name for key in after.keys] == ["a"]
    assert load_keys(path) == after
    with lock.open("rb+") as file:
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)


def test_a_change_that_fails_leaves_the_keys_and_no_lock(tmp_path: Path) -> None:
    path = tmp_path / "keys.toml"
    change_keys(path, lambda ring: ring.add(new_key("a", SigningRole.WATCH)))
    before = path.read_bytes()

    def refuse(ring: KeyRing) -> KeyRing:
        raise ValueError("no")

    with pytest.raises(ValueError, match="no"):
        change_keys(path, refuse)
    assert path.read_bytes() == before
    with path.with_name(".keys.toml.lock").open("rb+") as file:
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)


def test_a_lock_that_is_a_link_is_not_followed(tmp_path: Path) -> None:
    target = tmp_path / "target"
    target.touch()
    (tmp_path / ".keys.toml.lock").symlink_to(target)
    with pytest.raises(KeyFileError, match="no key was changed"):
        change_keys(tmp_path / "keys.toml", lambda ring: ring)
    assert not (tmp_path / "keys.toml").exists()


def test_keys_are_on_the_disk_before_they_count(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    synced: list[int] = []
    fsync = os.fsync

    def note(descriptor: int) -> None:
        synced.append(os.fstat(descriptor).st_ino)
        fsync(descriptor)

    monkeypatch.setattr(os, "fsync", note)
    path = tmp_path / "keys.toml"
    save_keys(path, KeyRing())
    assert synced == [path.stat().st_ino, tmp_path.stat().st_ino]


@pytest.mark.skipif(os.geteuid() != 0, reason="only root gives files away")
def test_the_lock_belongs_to_the_owner_of_the_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    ours, theirs = tmp_path / "ours", tmp_path / "theirs"
    for folder, user in ((ours, 1000), (theirs, 0)):
        folder.mkdir()
        os.chown(folder, 4242, 4243)
        with monkeypatch.context() as patched:
            patched.setattr(os, "geteuid", lambda user=user: user)
            lock = folder / ".keys.toml.lock"
            if user:
                change_keys(folder / "keys.toml", lambda ring: ring)
                assert (lock.stat().st_uid, lock.stat().st_gid) == (0, 0)
            else:
                change_keys(folder / "keys.toml", lambda ring: ring)
                assert (lock.stat().st_uid, lock.stat().st_gid) == (4242, 4243)


@pytest.mark.skipif(os.geteuid() != 0, reason="only root gives files away")
def test_only_root_reads_the_file_of_the_owner_of_a_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = write(tmp_path / "keys.toml", key())
    os.chown(path, 4242, -1)
    os.chown(tmp_path, 4242, -1)
    assert load_keys(path).find("laptop") is not None
    for user in (1, 1000):
        with monkeypatch.context() as patched:
            patched.setattr(os, "geteuid", lambda user=user: user)
            assert "belongs to user 4242" in problem(path)


def test_who_reads_keys_forbids_core_dumps(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    limits: list[tuple[int, tuple[int, int]]] = []

    def forbidden(kind: int, values: tuple[int, int]) -> None:
        limits.append((kind, values))
        raise ValueError("not allowed here")  # as where the limit cannot be changed

    monkeypatch.setattr(resource, "setrlimit", forbidden)
    assert load_keys(tmp_path / "keys.toml") == KeyRing()
    assert limits == [(resource.RLIMIT_CORE, (0, 0))]


def test_a_file_of_64_kb_is_read(tmp_path: Path) -> None:
    text = key()
    path = write(tmp_path / "keys.toml", text + "#" * (65536 - len(text)))
    assert load_keys(path).find("laptop") is not None
    path.write_text(text + "#" * (65537 - len(text)))
    assert "is larger than 65536 bytes" in problem(path)


def test_a_link_that_ends_nowhere_is_named_as_a_link(tmp_path: Path) -> None:
    (tmp_path / "link.toml").symlink_to(tmp_path / "none")
    assert "symbolic link" in problem(tmp_path / "link.toml")
    (tmp_path / "file").touch()
    assert "Not a directory" in problem(tmp_path / "file/keys.toml")


@pytest.mark.skipif(os.geteuid() != 0, reason="only root gives files away")
def test_an_owner_with_a_name_is_named(tmp_path: Path) -> None:
    path = write(tmp_path / "keys.toml", key())
    os.chown(path, 1, -1)
    text = problem(path)
    assert "belongs to daemon; chown root" in text


def test_a_key_that_is_chosen_signs(tmp_path: Path) -> None:
    text = key() + key("tablet", secret="cd" * 32)
    assert load_keys(write(tmp_path / "keys.toml", text)).sign_with == "laptop"
    assert load_keys(write(tmp_path / "keys.toml", f'sign_with = "tablet"\n{text}')).sign_with == "tablet"
    assert load_keys(write(tmp_path / "keys.toml", key(secret="AB" * 32))).keys[0].secret == bytes.fromhex(SECRET)
