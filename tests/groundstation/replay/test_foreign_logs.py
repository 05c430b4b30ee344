"""Logs as QGroundControl and Mission Planner write them, by their sources: they open, and what is lost is named.

- QGroundControl, src/Comms/MAVLinkProtocol.cc, receiveBytes() and logSentBytes(): the clock in ms, times 1000; logging
  begins behind the first HEARTBEAT; frames of all links in one file, those that are forwarded once more as sent bytes;
  on a full disk the last write is torn.
- Mission Planner, ExtLibs/ArduPilot/Mavlink/MAVLinkInterface.cs, SaveToTlog(): UtcNow, which stands still for up to
  15.6 ms on Windows, as TotalMilliseconds * 1000; sent and received frames of two threads; MAVLink 1 and 2, signed or
  not; flushed with each HEARTBEAT only. Beside it an .rlog: the bytes of the link without times.

MAVProxy and pymavlink write logs of their own in tests/interop/test_logs.py.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

import pytest

from dialects import messages as m
from groundstation.export.export import Export, ExportChoice, ExportOutput
from groundstation.export.exporter import ExportError
from groundstation.host.replay_process import ReplayError, open_log
from groundstation.intents import replay as r
from groundstation.replay import log_index
from groundstation.replay.log_replay import LogReplay
from tests.groundstation.replay.logs import GCS_TYPE, NO_AUTOPILOT, NOON, finish, open_desk
from tests.link.frames import frame, version_1
from tests.link.signing.signed import signed

VEHICLE, STATION = (1, 1), (255, 190)


@pytest.fixture(autouse=True)
def small_intervals(monkeypatch: pytest.MonkeyPatch) -> None:
    """Cut logs into intervals of 2 kB."""
    monkeypatch.setattr(log_index, "INTERVAL", 2048)


def rover(armed: bool = False) -> m.Heartbeat:
    """Return the HEARTBEAT of an ArduPilot rover."""
    return m.Heartbeat(10, 3, 0x81 if armed else 1, 0, 4, 3)


@dataclass
class ForeignLog:
    """Writes records as another ground station does. `clock`: its, s since its start."""

    resolution: int
    """us of its clock."""
    data: bytearray = field(default_factory=bytearray)
    clock: float = 0.0
    written: int = 0
    sequence: int = 0

    def add(self, raw: bytes) -> None:
        """Write a record."""
        stamp = round((NOON + self.clock) * 1e6) // self.resolution * self.resolution
        self.data += stamp.to_bytes(8, "big") + raw
        self.written += 1

    def hear(self, message: m.Message) -> bytes:
        """Write a received frame; return it."""
        self.sequence += 1
        raw = frame(message, self.sequence % 256, *VEHICLE)
        self.add(raw)
        return raw


def qgc_log() -> ForeignLog:
    """Return a log of QGroundControl with two links, and one to which all is forwarded."""
    log = ForeignLog(resolution=1000)
    for tenth in range(1, 300):
        log.clock = tenth / 10
        raw = log.hear(m.VfrHud(0, tenth / 10, 90, 0, 0, 0))
        log.add(raw)  # forwarded: as sent bytes
        if tenth % 10 == 0:
            log.add(log.hear(rover(armed=100 <= tenth < 200)))
            log.add(version_1(m.Heartbeat(GCS_TYPE, NO_AUTOPILOT, 0, 0, 4, 3), tenth % 256, *STATION))
        if tenth % 5 == 0:
            log.hear(m.Attitude(tenth * 100, 0.1, 0, 0, 0, 0, 0))
    return log


def planner_log() -> ForeignLog:
    """Return a log of Mission Planner: a slow clock, MAVLink 1 and 2, signed, and sent frames between them."""
    log = ForeignLog(resolution=15_625)
    for tenth in range(300):
        log.clock = tenth / 10 + (0.012 if tenth % 3 else 0.0)
        log.add(version_1(m.Heartbeat(GCS_TYPE, NO_AUTOPILOT, 0, 0, 4, 3), tenth % 256, *STATION))
        log.clock -= 0.02  # of another thread, which took its time before
        log.hear(rover(armed=100 <= tenth < 200))
        log.add(signed(m.VfrHud(0, tenth / 10, 90, 0, 0, 0), sequence=tenth % 256, ids=VEHICLE))
    return log


LOGS = {"qgc": qgc_log, "planner": planner_log}


@pytest.mark.parametrize("name", LOGS)
def test_it_opens_without_damage_in_even_time(name: str) -> None:
    log = LOGS[name]()
    desk = open_desk(bytes(log.data))
    index, events = desk.index, desk.index.findings.finder.events
    assert (index.frames, index.damaged, desk.check.damaged, index.tail) == (log.written, 0, 0, 0)
    assert index.duration == pytest.approx(29.9, abs=0.1)
    assert index.findings.finder.stations == {STATION}
    assert [each.kind for each in events] == ["MODE", "ARM", "ARM"]
    assert [each.time for each in events][1:] == pytest.approx([10.0, 20.0], abs=0.2)
    times = [time for number in range(len(index.starts)) for time, _ in index.timed_frames(number)]
    assert times == sorted(times)
    go_to(desk, "0:15")
    vehicle = desk.snapshot().vehicle
    assert vehicle is not None
    assert vehicle.armed
    assert vehicle.speed == pytest.approx(15, abs=0.2)


def go_to(desk: LogReplay, time: str) -> None:
    """Move to a time."""
    desk.handle(r.ReplayGoTo(time))
    finish(desk)


@pytest.mark.parametrize("name", LOGS)
@pytest.mark.parametrize(
    ("before", "behind", "cut"),
    [(b"", b"", 5), (b"", bytes(100_000), 0), (b"rest of a record", b"", 0), (b"", b"disk full", 40)],
    ids=["torn", "preallocated", "first entry cut", "both"],
)
def test_what_is_lost_at_its_ends_is_named(name: str, before: bytes, behind: bytes, cut: int, tmp_path: Path) -> None:
    data = bytes(LOGS[name]().data)
    data = before + (data[:-cut] if cut else data) + behind
    desk = open_desk(data)
    lost = desk.index.damaged + desk.index.tail
    assert len(before) + len(behind) <= lost < len(before) + len(behind) + 80
    log, out = tmp_path / "log.tlog", tmp_path / "out.tlog"
    log.write_bytes(data)
    assert open_log(log).size == len(data)
    export = Export(str(log), [ExportOutput("tlog", str(out))], ExportChoice())
    list(export.steps())
    assert export.result.damaged_bytes == lost == len(data) - out.stat().st_size


def test_a_clock_that_was_set_is_named_and_the_time_goes_on() -> None:
    log = planner_log()
    seam = len(log.data)
    log.data += bytes(planner_log().data)
    desk = open_desk(bytes(log.data))
    assert desk.index.frames == 2 * log.written
    assert [each.offset for each in desk.index.findings.finder.events if each.kind == "CLOCK"] == [seam]
    assert desk.index.duration == pytest.approx(59.8, abs=0.3)


def test_a_file_without_times_is_refused_with_what_to_open(tmp_path: Path) -> None:
    rlog = tmp_path / "2026-11-22 14-05-09.rlog"
    rlog.write_bytes(b"".join(frame(rover(), number, *VEHICLE) for number in range(100)))
    with pytest.raises(ReplayError, match=r"frames without times.*open the \.tlog"):
        open_log(rlog)
    with pytest.raises(ExportError, match=r"frames without times.*open the \.tlog"):
        list(Export(str(rlog), [ExportOutput("tlog", str(tmp_path / "x.tlog"))], ExportChoice()).steps())
