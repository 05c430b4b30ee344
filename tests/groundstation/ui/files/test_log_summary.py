"""Length and vehicles of telemetry logs, read from their ends."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import pytest

from dialects import messages as m
from dialects.codec import encode_payload, frame
from groundstation.ui.files.log_summary import HEAD, TAIL, LogSummary, read_summary, summarize
from link.tlog.tlog import encode_record

BEGUN = 1_790_000_000.0


def heartbeat(system: int, kind: int = 10, autopilot: int = 3, mode: int = 0) -> bytes:
    message = m.Heartbeat(kind, autopilot, mode, 0, 4, 3)
    return frame(message.id, encode_payload(message), 0, system, 1)


def speed(value: float) -> bytes:
    message = m.VfrHud(0.0, value, 0, 0, 0.0, 0.0)
    return frame(message.id, encode_payload(message), 0, 1, 1)


HEARTBEATS = (heartbeat(7), heartbeat(255, kind=6, autopilot=8), heartbeat(1, autopilot=0), heartbeat(9, autopilot=8))


def log(frames: Sequence[bytes], seconds: float, repeats: int = 1) -> bytes:
    """Frames at equal steps over so many seconds."""
    count = len(frames) * repeats
    times = (round((BEGUN + seconds * number / (count - 1)) * 1e6) for number in range(count))
    return b"".join(encode_record(at, frame) for at, frame in zip(times, tuple(frames) * repeats, strict=True))


@pytest.mark.parametrize("repeats", [1, 2000])
def test_a_log_has_a_length_and_vehicles(tmp_path: Path, repeats: int) -> None:
    (tmp_path / "a.tlog").write_bytes(log(HEARTBEATS, 754.0, repeats))
    found = read_summary(tmp_path / "a.tlog")
    assert found is not None
    assert found.length == pytest.approx(754.0, abs=0.01)
    assert found.systems == (1, 7)


def test_a_log_that_is_cut_has_the_length_up_to_there() -> None:
    data = log(HEARTBEATS, 99.0, 25)
    found = summarize(data, data[:-5])
    assert found is not None
    assert found.length == pytest.approx(98.0, abs=0.01)


def test_an_end_that_is_damaged_has_no_length() -> None:
    data = log(HEARTBEATS, 10.0)
    assert summarize(data, b"\xfd" * TAIL) == LogSummary(None, (1, 7))
    assert summarize(data, b"") == LogSummary(None, (1, 7))
    assert summarize(data, log(HEARTBEATS, 20 * 86_400.0)) == LogSummary(None, (1, 7)), "a time 20 days later"


@pytest.mark.parametrize("data", [b"", b"text", bytes(HEAD), b"\xfd" * HEAD, b"12345678\xfd"])
def test_another_file_is_no_log(tmp_path: Path, data: bytes) -> None:
    (tmp_path / "a.tlog").write_bytes(data)
    assert read_summary(tmp_path / "a.tlog") is None
    assert read_summary(tmp_path / "none.tlog") is None


@pytest.mark.parametrize("repeats", [20, 20_000], ids=["read whole", "in samples"])
def test_a_log_says_how_long_it_was_armed_and_drove(tmp_path: Path, repeats: int) -> None:
    rests, stands = [heartbeat(1), speed(0.0)], [heartbeat(1, mode=128), speed(0.02)]
    drives = [heartbeat(1, mode=128), speed(0.8)]
    parts = [each for part in (rests, stands, drives, drives) for each in part * repeats]
    (tmp_path / "a.tlog").write_bytes(log(parts, 400.0))
    found = read_summary(tmp_path / "a.tlog")
    assert found is not None
    assert found.armed == pytest.approx(300.0, rel=0.05)
    assert found.driven == pytest.approx(200.0, rel=0.05)
    assert not found.is_start


def test_a_short_log_in_which_nothing_was_armed_is_a_start(tmp_path: Path) -> None:
    for name, frames, seconds in (
        ("start", [heartbeat(1)] * 9, 5.0), ("long", [heartbeat(1)] * 9, 50.0),
        ("drive", [heartbeat(1, mode=128)] * 9, 5.0), ("silent", [speed(0.0)] * 9, 5.0),
    ):  # fmt: skip
        (tmp_path / name).write_bytes(log(frames, seconds))
        found = read_summary(tmp_path / name)
        assert found is not None
        assert found.is_start is (name == "start"), name
