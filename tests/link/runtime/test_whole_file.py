"""Files that are written whole or not at all."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from link.runtime.whole_file import PRIVATE, replace_file


def test_a_file_is_written_and_replaced(tmp_path: Path) -> None:
    path = tmp_path / "a.txt"
    replace_file(path, b"old")
    replace_file(path, b"new")
    assert path.read_bytes() == b"new"
    assert os.listdir(tmp_path) == ["a.txt"]


@pytest.mark.parametrize(("mode", "expected"), [(0o666, 0o640), (PRIVATE, 0o600)])
def test_the_mode_obeys_the_umask(tmp_path: Path, mode: int, expected: int) -> None:
    path = tmp_path / "a.txt"
    before = os.umask(0o027)
    try:
        replace_file(path, b"", mode=mode)
    finally:
        os.umask(before)
    assert path.stat().st_mode & 0o777 == expected


def test_a_failed_replacement_leaves_nothing_behind(tmp_path: Path) -> None:
    folder = tmp_path / "folder"
    folder.mkdir()
    (folder / "full").touch()
    with pytest.raises(OSError, match="directory"):
        replace_file(folder, b"data")
    assert os.listdir(tmp_path) == ["folder"]


def test_a_folder_that_does_not_exist_is_an_error(tmp_path: Path) -> None:
    with pytest.raises(FileNotFoundError):
        replace_file(tmp_path / "none" / "a.txt", b"data")


KILLED = """\
import os, signal, sys
from pathlib import Path
from link.runtime import whole_file

whole_file.Path.replace = lambda *_: os.kill(os.getpid(), signal.SIGKILL)
whole_file.replace_file(Path(sys.argv[1]), b"secret", mode=0o600)
"""
WRITES = """\
import sys
from pathlib import Path
from link.runtime import whole_file

def wait(*_):
    print("written", flush=True)
    sys.stdin.read()

whole_file.Path.replace = wait
whole_file.replace_file(Path(sys.argv[1]), b"secret", mode=0o600)
"""


def make_old(folder: Path) -> list[Path]:
    """Set the times of the temporary files back by a minute; return them."""
    found = [each for each in folder.iterdir() if each.name.startswith(".") and not each.is_symlink()]
    for each in found:
        os.utime(each, (each.stat().st_atime, each.stat().st_mtime - 60))
    return found


def test_what_a_killed_program_left_goes_at_the_next_change(tmp_path: Path) -> None:
    path = tmp_path / "keys.toml"
    killed = subprocess.run([sys.executable, "-c", KILLED, str(path)], check=False)
    assert killed.returncode == -signal.SIGKILL
    [left] = make_old(tmp_path)
    assert left.read_bytes() == b"secret"
    replace_file(path, b"new", mode=PRIVATE)
    assert os.listdir(tmp_path) == ["keys.toml"]


def test_a_file_that_is_written_now_and_foreign_ones_stay(tmp_path: Path) -> None:
    path = tmp_path / "keys.toml"
    foreign = [".keys.toml.bak", ".keys.toml.12345678.old", ".other.toml.12345678"]
    for name in foreign:
        (tmp_path / name).touch()
    (tmp_path / ".keys.toml.0123abcd").symlink_to(tmp_path / "elsewhere")
    command = [sys.executable, "-c", WRITES, str(path)]
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE) as writer:
        assert writer.stdin is not None
        assert writer.stdout is not None
        assert writer.stdout.readline() == b"written\n"
        before = {each.name for each in make_old(tmp_path)} | set(os.listdir(tmp_path))
        replace_file(path, b"new")
        assert set(os.listdir(tmp_path)) == before | {"keys.toml"}
        writer.stdin.close()


def test_one_that_is_too_new_to_be_locked_stays(tmp_path: Path) -> None:
    young, old = tmp_path / ".a.txt.0123abcd", tmp_path / ".a.txt.0123abce"
    young.touch()
    old.touch()
    os.utime(old, (0, 0))
    replace_file(tmp_path / "a.txt", b"")
    assert sorted(os.listdir(tmp_path)) == [young.name, "a.txt"]
