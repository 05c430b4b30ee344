"""Small telemetry logs, record by record."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

from dialects import codec
from dialects import messages as m
from dialects.enums import Command, ModeFlag, StationEventKind
from groundstation.replay.log_index import LogIndex
from groundstation.replay.log_replay import LogReplay
from groundstation.station.station import Station
from link.tlog.tlog import encode_record

NOON = 1_700_000_000.0
"""Wall clock at which a log begins, s."""

GCS_TYPE, ROVER_TYPE, ARDUPILOT, NO_AUTOPILOT = 6, 10, 3, 8
MANUAL, HOLD, AUTO = 0, 4, 10


class BytesSource:
    """A log in memory."""

    def __init__(self, data: bytes) -> None:
        self.data = data

    @property
    def size(self) -> int:
        """Bytes in it."""
        return len(self.data)

    def read(self, at: int, count: int) -> bytes:
        """Return up to `count` of them."""
        return self.data[at : at + count]


@dataclass
class LogWriter:
    """Writes records. `time` is that of the next one, s since the start."""

    data: bytearray = field(default_factory=bytearray)
    time: float = 0.0
    clock: float = NOON
    sequences: dict[tuple[int, int], int] = field(default_factory=dict)

    def add(self, message: m.Message, system: int = 1, component: int = 1) -> int:
        """Add a record; return its offset."""
        sequence = self.sequences.get((system, component), 0)
        self.sequences[system, component] = sequence + 1
        raw = codec.frame(type(message).id, codec.encode_payload(message), sequence & 0xFF, system, component)
        self.data += encode_record(round((self.clock + self.time) * 1e6), raw)
        return len(self.data) - len(raw) - 8

    def beat(self, mode: int = MANUAL, *, armed: bool = False) -> int:
        """Add the HEARTBEAT of an ArduPilot rover."""
        base = ModeFlag.CUSTOM | (ModeFlag.ARMED if armed else 0)
        return self.add(m.Heartbeat(ROVER_TYPE, ARDUPILOT, base, mode, 4 if armed else 3, 3))

    def station_beat(self) -> int:
        """Add the HEARTBEAT of a ground station."""
        return self.add(m.Heartbeat(GCS_TYPE, NO_AUTOPILOT, 0, 0, 4, 3), 255, 190)

    def drive(self, throttle: float) -> int:
        """Add a demand of the ground station in ArduPilot's axes."""
        return self.add(m.ManualControl(1, 0, 0, round(1000 * throttle), 0, 0), 255, 190)

    def note(self, kind: StationEventKind, text: str, throttle: float = 0.0) -> int:
        """Add a note of the ground station."""
        note = m.RoverStationEvent(kind, 6, 1, round(1000 * throttle), 0, text.encode())
        return self.add(note, 255, 190)

    def say(self, text: str, severity: int = 6) -> int:
        """Add a STATUSTEXT of the vehicle."""
        return self.add(m.StatusText(severity, text.encode()))


def drive_log(seconds: int = 60) -> LogWriter:
    """Return a drive: armed from 10 s to 50 s, AUTO from 30 s to 40 s, a warning at 20 s, speed as the time."""
    log = LogWriter()
    for tenth in range(seconds * 10):
        log.time = tenth / 10
        armed = 100 <= tenth < 500
        if tenth % 10 == 0:
            log.beat(AUTO if 300 <= tenth < 400 else MANUAL, armed=armed)
            log.station_beat()
            log.add(m.SysStatus(0, 0, 0, 0, 12_600 - tenth, 100, 80, 0, 0, 0, 0, 0, 0))
        if tenth == 200:
            log.say("fence close", 4)
        if tenth == 99:
            log.add(m.CommandLong(1, 1, Command.COMPONENT_ARM_DISARM, 0, 1, 0, 0, 0, 0, 0, 0), 255, 190)
            log.add(m.CommandAck(Command.COMPONENT_ARM_DISARM, 0))
        if armed:
            log.drive(0.5)
        log.add(m.VfrHud(0, tenth / 10, 90, 0, 0, 0))
    return log


def keys_log() -> LogWriter:
    """Return a drive of 40 s by keys: i from 10 s on, u with it from 15 to 20 s, all up at 30 s; a look at the map."""
    log, kind = LogWriter(), StationEventKind
    notes = {
        50: (kind.SCREEN, "map", 0.0),
        100: (kind.KEYS_DOWN, "i", 0.5),
        150: (kind.KEYS_DOWN, "u", 0.5),
        200: (kind.KEYS_UP, "u: released", 0.5),
        300: (kind.KEYS_UP, "neutral, no repeat of a key that was held for a long time", 0.0),
    }
    for tenth in range(400):
        log.time = tenth / 10
        if tenth % 10 == 0:
            log.beat(armed=True)
            log.station_beat()
        if tenth in notes:
            log.note(*notes[tenth])
        if 100 <= tenth < 300:
            log.drive(0.5)
        log.add(m.VfrHud(0, 0.5, 90, 0, 0, 0))
    return log


def indexed(data: bytes) -> LogIndex:
    """Return the whole index of a log."""
    index = LogIndex(BytesSource(data))
    while index.advance():
        pass
    return index


def build_station(system: int, now: float) -> Station:
    """Return a station without links."""
    return Station(("test.tlog",), system=system, now=now)


def open_desk(data: bytes, *, at: str = "", build: Callable[[int, float], Station] = build_station) -> LogReplay:
    """Return a desk whose work is done."""
    desk = LogReplay("test.tlog", BytesSource(data), build, at=at)
    finish(desk)
    return desk


def finish(desk: LogReplay) -> None:
    """Do all work."""
    for _ in range(10_000):
        if not desk.work():
            return
    raise AssertionError("the work never ends")
