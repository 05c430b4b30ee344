"""Logs to export: of a rover that drives, with everything that exporters read, and one of a real ArduRover."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path

from dialects import messages as m
from groundstation.export.export import Export, ExportChoice, ExportOutput, ExportResult
from link.tlog.tlog import encode_record
from tests.link.frames import frame

ARDUROVER = Path(__file__).parents[2] / "recordings" / "ardurover.tlog"
"""Traffic between an ArduRover (SITL) and a ground station; 446 messages are of ardupilotmega.xml."""
START = 1_795_000_000_000_000
"""us; 2026-11-18T11:06:40Z."""
STEP = 100_000

YAW = math.radians(30)
POINTS = [(-353_629_380 + 100 * number, 1_491_650_850 + 50 * number) for number in range(20)]
"""Latitude and longitude, degrees x 1e7."""


def sent(moment: int, message: m.Message, system: int = 1, component: int = 1) -> bytes:
    """Return the record of a message, `moment` x 0.1 s from the start."""
    return encode_record(START + moment * STEP, frame(message, moment % 256, system, component))


HEARTBEAT = m.Heartbeat(10, 3, 0xC1, 4, 4, 3)
BEAT = sent(0, HEARTBEAT)


def drive() -> bytes:
    """Return a log of 2 s."""
    log = [BEAT, sent(0, m.Heartbeat(6, 8, 0, 0, 4, 3), 255, 190)]
    for number, (latitude, longitude) in enumerate(POINTS):
        log += [sent(number, each) for each in telemetry(number, latitude, longitude)]
        log.append(sent(number, m.ManualControl(1, 32767, 250, 500, 32767, 0), 255, 190))
    log.append(sent(15, m.StatusText(3, b"<Wheel> & \x1b[31mblocked\x07 \xf0")))
    return b"".join(log)


def session() -> bytes:
    """Return a log of a session: with notes of the station, which programs without our dialect do not know."""
    notes = [m.RoverStationEvent(2, 6, 1, 500, -250, f"i down {number}".encode()) for number in range(3)]
    places = [sent(21 + number, m.GlobalPositionInt(0, *POINTS[number], 0, 0, 0, 0, 0, 0)) for number in range(3)]
    return drive() + b"".join(sent(20, each, 255, 190) + place for each, place in zip(notes, places, strict=True))


def telemetry(number: int, latitude: int, longitude: int) -> Sequence[m.Message]:
    """Return what a vehicle sends at one moment."""
    return (
        m.GlobalPositionInt(number, latitude, longitude, 584_000, 0, 120, 0, 0, 3000),
        gps(latitude, longitude),
        m.Attitude(number, 0.1, -0.2, YAW, 0.01, 0.02, 0.03),
        m.ScaledImu(number, 100, -50, -1000, 0, 0, 0, 0, 0, 0),
        m.LocalPositionNed(number, 3.0, 4.0, -0.5, math.cos(YAW), math.sin(YAW), 0.0),
        battery(),
    )


def gps(latitude: int, longitude: int, fix: int = 3, ellipsoid: int = 603_000) -> m.GpsRawInt:
    """Return a position of a receiver."""
    return m.GpsRawInt(
        0, fix, latitude, longitude, 584_000, 121, 200, 120, 3000, 9, ellipsoid, 1500, 3000, 0, 0, 0,
    )  # fmt: skip


def battery(current: int = 1234, remaining: int = 55) -> m.BatteryStatus:
    """Return a battery of three cells."""
    return m.BatteryStatus(
        0, 0, 1, 2150, [4100, 4000, 3900, *[65535] * 7], current, 0, 0, remaining, 0, 1, [0] * 4, 0, 0
    )  # fmt: skip


def run(log: Path, *outputs: tuple[str, Path], choice: ExportChoice | None = None) -> ExportResult:
    """Export a log."""
    export = Export(str(log), [ExportOutput(name, str(path)) for name, path in outputs], choice or ExportChoice())
    for done in export.steps():
        assert 0 <= done <= export.size
    return export.result
