"""Kept parameters: whole or not at all, whatever the disk does."""

from __future__ import annotations

import errno
import os
import stat
import subprocess
import sys
import threading
from collections.abc import Callable
from pathlib import Path

import pytest

from vehicle.storage.file_writer import FileWriter
from vehicle.storage.param_store import ParamStore

VALUES = {"MAN_TIMEOUT": 0.4, "SPEED_MAX": 2.0}


def kept(folder: Path, **values: float) -> ParamStore:
    store = ParamStore(FileWriter(folder))
    for name, value in values.items():
        store.set(name, value)
    store.close()
    return store


def test_a_first_start_has_nothing_and_no_damage(tmp_path: Path) -> None:
    store = ParamStore(FileWriter(tmp_path / "not" / "there"))
    assert (store.values, store.damage, store.problem) == ({}, None, None)
    store.close()


def test_values_survive_a_restart(tmp_path: Path) -> None:
    folder = tmp_path / "state" / "mavhelm"
    kept(folder, **VALUES)
    assert ParamStore(FileWriter(folder)).values == VALUES
    kept(folder, SPEED_MAX=3.0)
    again = ParamStore(FileWriter(folder))
    assert again.values == {"MAN_TIMEOUT": 0.4, "SPEED_MAX": 3.0}
    assert again.damage is None
    assert os.listdir(folder) == ["parameters"]
    assert stat.S_IMODE((folder / "parameters").stat().st_mode) == 0o600


@pytest.mark.parametrize("text", [b"", b"MAN_TIMEOUT 0.4\n", b"\0" * 100])
def test_a_damaged_file_is_kept_aside_until_a_good_one(tmp_path: Path, text: bytes) -> None:
    kept(tmp_path, **VALUES)
    (tmp_path / "parameters").write_bytes(text)
    for _ in range(2):  # a restart does not make it good
        store = ParamStore(FileWriter(tmp_path))
        assert store.values == {}
        assert store.damage == "parameter file damaged"
        assert (tmp_path / "parameters.damaged").read_bytes() == text
    kept(tmp_path, SPEED_MAX=2.5)
    store = ParamStore(FileWriter(tmp_path))
    assert (store.values, store.damage) == ({"SPEED_MAX": 2.5}, None)
    assert (tmp_path / "parameters.damaged").exists()


def test_a_file_that_cannot_be_read_is_damage_too(tmp_path: Path) -> None:
    (tmp_path / "parameters").mkdir()
    assert ParamStore(FileWriter(tmp_path)).damage == "parameter file cannot be read, Is a directory"


@pytest.mark.parametrize("make", [os.mkfifo, lambda path: path.symlink_to("/dev/zero")])
def test_a_file_without_an_end_is_neither_waited_for_nor_read(make: Callable[[Path], None], tmp_path: Path) -> None:
    make(tmp_path / "parameters")
    assert ParamStore(FileWriter(tmp_path)).damage == "parameter file cannot be read, not a regular file"


def test_a_full_disk_is_a_problem_and_the_old_file_stays(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    kept(tmp_path, **VALUES)

    def full(descriptor: int) -> None:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    with monkeypatch.context() as patched:
        patched.setattr(os, "fsync", full)
        assert kept(tmp_path, SPEED_MAX=9.0).problem == "No space left on device"
    assert ParamStore(FileWriter(tmp_path)).values == VALUES
    assert kept(tmp_path, SPEED_MAX=9.0).problem is None


def test_to_keep_does_not_wait_for_the_disk(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    released, writing = threading.Event(), threading.Event()
    fsync = os.fsync

    def slow(descriptor: int) -> None:
        writing.set()
        assert released.wait(60)
        fsync(descriptor)

    monkeypatch.setattr(os, "fsync", slow)
    store = ParamStore(FileWriter(tmp_path))
    store.set("SPEED_MAX", 2.0)
    assert writing.wait(60)
    store.set("SPEED_MAX", 3.0)  # returned, though the disk hangs
    released.set()
    store.close()
    assert ParamStore(FileWriter(tmp_path)).values == {"SPEED_MAX": 3.0}


KILLED_WHILE_WRITING = """
import os, signal, sys
from pathlib import Path
from vehicle.storage.file_writer import FileWriter
from vehicle.storage.param_store import ParamStore
calls = int(sys.argv[2])
def dying(call):
    def wrapped(*words, **options):
        global calls
        if not calls:
            os.kill(os.getpid(), signal.SIGKILL)
        calls -= 1
        return call(*words, **options)
    return wrapped
store = ParamStore(FileWriter(Path(sys.argv[1])))  # reading is not what dies
for name in ("open", "write", "fsync", "close"):
    setattr(os, name, dying(getattr(os, name)))
Path.replace = dying(Path.replace)
store.set("SPEED_MAX", 9.0)
store.close()
"""


@pytest.mark.parametrize("calls", range(8))
def test_64_kill_at_any_step_of_a_save_leaves_the_old_or_the_new(tmp_path: Path, calls: int) -> None:
    kept(tmp_path, **VALUES)
    ended = subprocess.run([sys.executable, "-c", KILLED_WHILE_WRITING, str(tmp_path), str(calls)], check=False)
    assert ended.returncode == -9
    store = ParamStore(FileWriter(tmp_path))
    assert store.damage is None
    assert store.values in (VALUES, {**VALUES, "SPEED_MAX": 9.0})
    assert (store.values == VALUES) is (calls <= 4)
