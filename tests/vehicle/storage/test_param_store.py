"""Kept parameters: whole or not at all, whatever the disk does."""

from __future__ import annotations

import errno
import os
import stat
import subprocess
import sys
import threading
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from vehicle.config import effective_params
from vehicle.config.run_settings import RunSettings, Simulation
from vehicle.params import PARAMETERS
from vehicle.runtime.factory import build_params
from vehicle.storage.checksummed_file import CorruptFileError
from vehicle.storage.file_writer import FileWriter
from vehicle.storage.param_file import decode, encode
from vehicle.storage.param_store import ParamStore

VALUES = {"MAN_TIMEOUT": 0.4, "SPEED_MAX": 2.0}

NUMBERS = st.dictionaries(st.sampled_from(sorted(PARAMETERS)), st.floats(allow_nan=False, allow_infinity=False))


def kept(folder: Path, **values: float) -> ParamStore:
    store = ParamStore(FileWriter(folder))
    for name, value in values.items():
        store.set(name, value)
    store.close()
    return store


@given(NUMBERS)
def test_what_is_written_is_read_to_the_last_digit(values: dict[str, float]) -> None:
    assert decode(encode(values)) == values


@given(NUMBERS, st.data())
def test_half_a_file_is_damaged(values: dict[str, float], data: st.DataObject) -> None:
    whole = encode(values)
    with pytest.raises(CorruptFileError):
        decode(whole[: data.draw(st.integers(0, len(whole) - 1))])


@given(NUMBERS, st.data())
def test_a_flipped_bit_is_damage(values: dict[str, float], data: st.DataObject) -> None:
    whole = bytearray(encode(values))
    whole[data.draw(st.integers(0, len(whole) - 1))] ^= 1 << data.draw(st.integers(0, 7))
    with pytest.raises(CorruptFileError):
        decode(bytes(whole))


@given(st.binary())
def test_any_bytes_are_values_or_damage(data: bytes) -> None:
    with pytest.raises(CorruptFileError):
        decode(data)


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
def test_a_damaged_file_is_kept_aside_and_stays_damage_until_a_good_one(tmp_path: Path, text: bytes) -> None:
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


@pytest.mark.timeout(20)
@pytest.mark.parametrize("make", [os.mkfifo, lambda path: path.symlink_to("/dev/zero")])
def test_a_file_without_an_end_is_neither_waited_for_nor_read(make: Callable[[Path], None], tmp_path: Path) -> None:
    make(tmp_path / "parameters")
    assert ParamStore(FileWriter(tmp_path)).damage == "parameter file cannot be read, not a regular file"


def test_a_disk_that_takes_nothing_is_a_problem_and_the_old_file_stays(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
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


def test_a_slow_disk_gets_the_newest_of_many_wishes(tmp_path: Path) -> None:
    released, writing = threading.Event(), threading.Event()
    made: list[str] = []

    def slow() -> bytes:
        writing.set()
        assert released.wait(60)
        return b"first"

    def made_of(word: str) -> bytes:
        made.append(word)
        return word.encode()

    writer = FileWriter(tmp_path)
    writer.write("parameters", slow)
    assert writing.wait(60)
    for number in range(1000):
        writer.write("parameters", partial(made_of, f"{number}"))
    writer.write("fence", partial(made_of, "fence"))
    released.set()
    writer.close()
    assert made == ["999", "fence"]
    assert [(tmp_path / name).read_bytes() for name in ("parameters", "fence")] == [b"999", b"fence"]


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
def test_64_killed_at_any_step_of_a_save_leaves_the_old_file_or_the_new(tmp_path: Path, calls: int) -> None:
    kept(tmp_path, **VALUES)
    ended = subprocess.run([sys.executable, "-c", KILLED_WHILE_WRITING, str(tmp_path), str(calls)], check=False)
    assert ended.returncode == -9
    store = ParamStore(FileWriter(tmp_path))
    assert store.damage is None
    assert store.values in (VALUES, {**VALUES, "SPEED_MAX": 9.0})
    assert (store.values == VALUES) is (calls <= 4)


def test_what_wins(tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    """Kept over defaults, the file of settings over kept, this run over all."""
    kept(tmp_path, SPEED_MAX=2.0, TRACK_WIDTH=1.0, WHEELBASE=1.0, GONE=1.0, MAN_TIMEOUT=99.0)
    settings = RunSettings((), pinned={"TRACK_WIDTH": 2.0}, params={"WHEELBASE": 3.0})
    params = build_params(settings, ParamStore(FileWriter(tmp_path)))
    assert [params[name] for name in ("SPEED_MAX", "TRACK_WIDTH", "WHEELBASE", "MAN_TIMEOUT")] == [2.0, 2.0, 3.0, 0.45]
    assert params.pinned == {"TRACK_WIDTH"}
    assert params.run_values == {"WHEELBASE": 3.0}
    assert [record.levelname for record in caplog.records] == ["WARNING", "WARNING"]
    assert params.damage is None


def test_a_known_cars_parameters_are_its_defaults(tmp_path: Path) -> None:
    kept(tmp_path, MOT2_MAX=80.0)
    settings = RunSettings((), motors={"driver": "article-car"}, pinned={"MOT_PIVOT_MAX": 50.0})
    params = build_params(settings, ParamStore(FileWriter(tmp_path)))
    assert [params[name] for name in ("MOT1_MAX", "MOT2_MAX", "MOT_PIVOT_MAX")] == [60.0, 80.0, 50.0]
    simulated = build_params(replace(settings, simulation=Simulation()), ParamStore())
    assert simulated["MOT1_MAX"] == 100.0


def test_where_the_programs_beside_a_vehicle_look(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path / "home"))
    monkeypatch.delenv("STATE_DIRECTORY", raising=False)
    monkeypatch.setattr(effective_params, "SERVICE", tmp_path / "service")
    assert effective_params.state_folder_of(None) == tmp_path / "home" / "mavhelm"
    (tmp_path / "service").symlink_to("/no/such/folder")  # of a user that exists only while the service runs
    assert effective_params.state_folder_of(None) == tmp_path / "service"
    monkeypatch.setenv("STATE_DIRECTORY", "/run/one:/run/two")
    assert effective_params.state_folder_of(None) == Path("/run/one")
    assert effective_params.state_folder_of("/srv/rover") == Path("/srv/rover")


def test_damage_reaches_the_arming_checks(tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    (tmp_path / "parameters").write_text("half")
    assert build_params(RunSettings(()), ParamStore(FileWriter(tmp_path))).damage == "parameter file damaged"
    assert "arming is denied" in caplog.text


def test_damage_is_told_with_its_folder(tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    (tmp_path / "parameters").write_text("half")
    build_params(RunSettings((), state=tmp_path), ParamStore(FileWriter(tmp_path)))
    assert f"{tmp_path}: parameter file damaged: all saved parameters" in caplog.text
