"""Telemetry logs: what we write others read, and damage costs what it hit and no more."""

from __future__ import annotations

from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from dialects.messages import Attitude, Heartbeat
from link.bridge.recorder import RecorderError, open_recorder
from link.tlog.tlog import Record, encode_record, read_records
from tests.link.frames import demand, frame, heartbeat, version_1
from tests.link.routing.test_router import unknown

START = 1_700_000_000_000_000
FRAMES = [frame(Attitude(number, 0.5, 0, 0, 0, 0, 1), number % 256, 1, 1) for number in range(100)]
LOG = b"".join(encode_record(START + number * 1000, raw) for number, raw in enumerate(FRAMES))
SIZE = len(encode_record(0, FRAMES[50]))


def test_what_is_written_is_read() -> None:
    raws = [heartbeat(0), version_1_heartbeat(), unknown(1), demand(2), unknown(3)]
    log = b"".join(encode_record(START + number, raw) for number, raw in enumerate(raws))
    assert list(read_records(log)) == [Record(START + number, raw) for number, raw in enumerate(raws)]
    assert log[:8] == START.to_bytes(8, "big")


def version_1_heartbeat() -> bytes:
    return version_1(Heartbeat(6, 8, 0, 0, 4, 3))


@given(st.integers(0, len(LOG)))
def test_a_log_that_was_cut_is_whole_up_to_there(length: int) -> None:
    found = [each.raw for each in read_records(LOG[:length])]
    assert found == FRAMES[: len(found)]
    assert sum(len(each) + 8 for each in found) > length - 60


def test_zeros_in_the_middle_cost_the_records_they_hit() -> None:
    at = 1003
    found = list(read_records(LOG[:at] + bytes(400) + LOG[at + 400 :]))
    assert len(FRAMES) - 11 <= len(found) < len(FRAMES)
    assert found[-1] == Record(START + 99_000, FRAMES[99])
    stamps = [each.microseconds for each in found]
    assert stamps == sorted(stamps)


def test_a_torn_record_in_the_middle_costs_itself() -> None:
    # As after a power cut and a restart that went on in the same file.
    half = LOG[: SIZE * 10 + 20]
    found = [each.raw for each in read_records(half + LOG[SIZE * 20 :])]
    assert found[-1] == FRAMES[-1]
    assert len(found) > 80


@given(st.binary(max_size=400))
def test_any_bytes_are_read_without_raising(soup: bytes) -> None:
    found = [each.raw for each in read_records(soup + LOG)]
    assert FRAMES[-1] in found
    assert len(found) > 90


# ---- the bridge's recorder ----


def test_a_session_is_one_file_and_pymavlink_reads_it(tmp_path: Path) -> None:
    path, recorder = open_recorder(tmp_path / "logs")
    other, second = open_recorder(tmp_path / "logs")
    for number, raw in enumerate(FRAMES):
        recorder.add(100.0 + number * 0.02, [raw, heartbeat(number)])
        recorder.tick(100.0 + number * 0.02)
    recorder.close()
    second.close()
    assert other != path
    assert [each.raw for each in read_records(path.read_bytes())][::2] == FRAMES
    assert read_by_pymavlink(path) == [("ATTITUDE", 1), ("HEARTBEAT", 255)] * 100


def read_by_pymavlink(path: Path) -> list[tuple[str, int]]:
    """Kind and system of each message."""
    from pymavlink import mavutil

    log = mavutil.mavlink_connection(str(path))  # type: ignore[no-untyped-call]
    found = []
    while (message := log.recv_match()) is not None:
        found.append((message.get_type(), message.get_srcSystem()))
    log.close()
    return found


def test_nowhere_to_record_is_one_line(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(RecorderError, match=r"--tlog .*file"):
        open_recorder(tmp_path / "file")
