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


def heartbeat(system: int, kind: int = 10, autopilot: int = 3) -> bytes:
    message = m.Heartbeat(kind, autopilot, 0, 0, 4, 3)
    return frame(message.id, encode_payload(message), 0, system, 1)


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
