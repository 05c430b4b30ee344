"""The recording of a real session with the simulator: what a kill -9 leaves, and a disk that takes nothing more."""

from __future__ import annotations

import os
import resource
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

import pytest

from dialects import codec
from dialects import messages as m
from dialects.enums import StationEventKind as Kind
from groundstation.intents.driving import DriveKeyUp
from groundstation.recording.options import RecordOptions
from link.tlog.tlog import Record, read_records
from tests.groundstation.screen import FORWARD, Screen
from tests.waits import Waits, wait_until

pytestmark = pytest.mark.e2e

LOST = 0.2
"""s before a kill that may be missing."""


def only_log(folder: Path) -> list[Record]:
    (path,) = folder.glob("*.tlog")
    return list(read_records(path.read_bytes()))


def messages(records: list[Record], kind: type[m.Message]) -> list[m.Message]:
    frames = [record.raw for record in records if int.from_bytes(record.raw[7:10], "little") == kind.id]
    return [codec.decode(kind.id, raw[10:-2]) for raw in frames]


def notes(records: list[Record]) -> list[tuple[Kind, str]]:
    found = messages(records, m.RoverStationEvent)
    return [(Kind(each.kind), m.decode_text(each)) for each in found if isinstance(each, m.RoverStationEvent)]


def run_tool(name: str, log: Path) -> str:
    """Run a tool of the installed pymavlink, which does not know our messages."""
    tool = Path(sys.executable).with_name(name)
    ended = subprocess.run([sys.executable, tool, log], capture_output=True, text=True, timeout=60)
    assert ended.returncode == 0, ended.stderr
    return ended.stdout


def test_kill_loses_less_than_0_2_s_and_pymavlink_reads_the_log(tmp_path: Path) -> None:
    options = RecordOptions(tmp_path, 100, 2000)
    with Screen(sitl=True, record=options) as screen:
        screen.hold_forward()
        screen.turn_wheels(lambda: screen.speed > 0.3)
        screen.client.send(DriveKeyUp(key="i"))
        screen.see(lambda seen: not seen.operator.throttle)
        screen.client.send(FORWARD)
        screen.see(lambda seen: seen.operator.throttle > 0 and seen.recording is not None and seen.recording.size > 0)
        waits = Waits(screen.client.pid)
        begun = time.time()
        screen.see(lambda seen: time.time() - begun > 0.5)
        os.kill(screen.client.pid, signal.SIGKILL)
        killed = time.time()
    records = only_log(tmp_path)
    assert killed - records[-1].microseconds / 1e6 < LOST + waits.total()
    assert [record.microseconds for record in records] == sorted(record.microseconds for record in records)
    keys = [text for kind, text in notes(records) if kind in (Kind.KEYS_DOWN, Kind.KEYS_UP)]
    assert keys[-3:] == ["i", "i: released", "i"]
    assert (Kind.CONTROL, "Rover 1: ground station 255 (this one) in control") in notes(records)
    assert (Kind.MARK, "recording ends") not in notes(records)
    driven = messages(records, m.RoverOperatorPresence)
    assert vars(driven[-1])["x"] == 600
    assert len(messages(records, m.Attitude)) > 3
    (log,) = tmp_path.glob("*.tlog")
    dump = run_tool("mavlogdump.py", log)
    assert "MANUAL_CONTROL {" in dump
    assert "UNKNOWN_46006" in dump
    assert "BAD_DATA" not in dump
    assert "Total distance" in run_tool("mavsummarize.py", log)
    assert " 0 points" not in run_tool("mavtogpx.py", log)


@contextmanager
def file_size_limit(size: int) -> Iterator[None]:
    """Let programs that are started here write no longer files than `size` bytes."""
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (size, before[1]))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)


def test_a_failing_disk_is_told_once_and_driving_goes_on(tmp_path: Path) -> None:
    log_file = tmp_path / "station.log"
    options = RecordOptions(tmp_path / "logs", 100, 2000)
    with file_size_limit(6000):
        screen = Screen(sitl=True, record=options, log_file=log_file)
    with screen:
        screen.hold_forward()
        seen = screen.see(lambda seen: seen.recording is not None and bool(seen.recording.problem))
        assert seen.recording is not None
        assert seen.recording.problem == f"not recording: File too large ({tmp_path / 'logs'})"
        screen.turn_wheels(lambda: screen.speed > 0.3)
        screen.client.send(DriveKeyUp(key="i"))
        screen.see(lambda seen: seen.vehicle is not None and (seen.vehicle.speed or 0) < 0.02)
        assert log_file.read_text().count("not recording") == 1
    assert only_log(tmp_path / "logs"), "what was written before can be read"


@contextmanager
def small_disk(folder: Path) -> Iterator[Path]:
    """Mount a disk of 40 MB."""
    folder.mkdir()
    mounted = subprocess.run(
        ["mount", "-t", "tmpfs", "-o", "size=40m", "tmpfs", folder], capture_output=True, text=True
    )
    if mounted.returncode:
        pytest.skip(f"no disk can be mounted here: {mounted.stderr.strip()}")
    try:
        yield folder
    finally:
        subprocess.run(["umount", "--lazy", folder], check=True)


def fill_disk(filler: Path) -> None:
    """Write a file into all room of its disk, of which the recorder takes some meanwhile."""
    with suppress(OSError), filler.open("wb", buffering=0) as file:
        while True:
            file.write(bytes(1 << 16))


@pytest.mark.slow
@pytest.mark.skipif(os.geteuid() != 0, reason="only root mounts disks")
def test_full_disk_is_told_once_and_recording_resumes_with_room(tmp_path: Path) -> None:
    log_file = tmp_path / "station.log"
    with small_disk(tmp_path / "disk") as disk:
        old = [disk / f"2020-01-0{day}_00-00-00.tlog" for day in (1, 2, 3)]
        for path in old:
            path.write_bytes(bytes(1_500_000))
        filler = disk / "filler"
        with Screen(sitl=True, record=RecordOptions(disk, 1, 3), log_file=log_file) as screen:
            first = screen.see(lambda seen: seen.recording is not None and seen.recording.size > 1000).recording
            assert first is not None
            assert [path.exists() for path in old] == [False, False, True], "the oldest make room"
            fill_disk(filler)
            seen = screen.see(lambda seen: bool(seen.recording and seen.recording.problem)).recording
            assert seen is not None
            assert seen.problem.endswith((f"MiB free ({disk})", f"No space left on device ({disk})"))
            screen.hold_forward()
            screen.turn_wheels(lambda: screen.speed > 0.3)
            screen.client.send(DriveKeyUp(key="i"))
            filler.unlink()
            again = screen.see(lambda seen: bool(seen.recording and not seen.recording.problem)).recording
            assert again is not None
            assert again.path not in ("", first.path)
            screen.see(lambda seen: bool(seen.recording and seen.recording.size > 1000))
            assert log_file.read_text().count("not recording") == 1
        assert all(list(read_records(Path(log.path).read_bytes())) for log in (first, again))


def test_an_end_in_order_is_in_the_log(tmp_path: Path) -> None:
    with Screen(sitl=True, record=RecordOptions(tmp_path, 100, 2000)) as screen:
        screen.see(lambda seen: seen.recording is not None and seen.recording.size > 0)
        assert screen.client.close() == 0
        wait_until(lambda: not screen.client.alive)
    assert notes(only_log(tmp_path))[-1] == (Kind.MARK, "recording ends")
