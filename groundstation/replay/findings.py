"""What an index finds beside the places: events, speed, the driver's demand, modes, parameters, damage, losses."""

from __future__ import annotations

import math
import operator
import struct
from array import array
from bisect import bisect_left
from collections.abc import Callable
from typing import Any, NamedTuple

from dialects import messages as m
from dialects.axes import NEUTRAL, axis_map, parse_axes
from dialects.codec import CRC_SIZE, HEADER_V2, MAGIC_V2, decode
from dialects.enums import Severity
from groundstation.replay.events import EVENT_IDS, EventFinder, Found, LogEvent
from groundstation.replay.plans import PLAN_IDS, PlanHistory, describe
from link.protocol.frame import payload_of
from link.tlog.scan import STAMP, LogFrame, SourceKey

MAX_BUCKETS = 4096
"""More than any terminal has columns of dots."""

FIRST_STEP = 0.1
"""s of a bucket at first; it doubles when the log grows longer than the buckets."""


class Buckets:
    """One number for each step of time: the largest of the values in it, or their sum."""

    def __init__(self, join: Callable[[float, float], float] = max) -> None:
        self._join = join
        self._values = array("d")
        self._step = FIRST_STEP

    def add(self, at: float, value: float) -> None:
        """Add a value at a time, s since the start."""
        while (number := int(at / self._step)) >= MAX_BUCKETS:
            self._halve()
        while len(self._values) <= number:
            self._values.append(math.nan)
        before = self._values[number]
        self._values[number] = value if math.isnan(before) else self._join(before, value)

    def _halve(self) -> None:
        pairs = zip(self._values[::2], [*self._values[1::2], math.nan], strict=False)
        self._values = array("d", (self._both(first, second) for first, second in pairs))
        self._step *= 2

    def _both(self, first: float, second: float) -> float:
        if math.isnan(first) or math.isnan(second):
            return second if math.isnan(first) else first
        return self._join(first, second)

    def columns(self, count: int, end: float) -> tuple[float | None, ...]:
        """Return the value of each of `count` equal parts of the time from 0 to `end`; None where there is none."""
        if end <= 0:
            return (None,) * count
        return tuple(self._column(end * column / count, end * (column + 1) / count) for column in range(count))

    def _column(self, start: float, end: float) -> float | None:
        """Return the value of a part; one that is shorter than a bucket has that of its bucket."""
        first = int(start / self._step)
        value = math.nan
        for number in range(first, min(len(self._values), max(first + 1, math.ceil(end / self._step)))):
            value = self._both(value, self._values[number])
        return None if math.isnan(value) else value


KEPT = {m.StatusText.id}
"""Messages of which the last one is not enough to rebuild the state: the newest MAX_KEPT before a moment are read."""

MAX_KEPT = 20_000
MAX_PARAMS = 10_000
MAX_DAMAGE_EVENTS = 500
_NAME = slice(8, 24)
"""Name in the payload of a PARAM_VALUE."""
_SPEED = struct.Struct("<f")


class KnownBeat(NamedTuple):
    """The newest HEARTBEAT of a sender, as an unsigned frame of MAVLink 2."""

    head: bytes
    """Start byte, length, incompatibility flags."""
    payload: bytes
    system: int
    component: int

    @property
    def size(self) -> int:
        """Bytes of its record."""
        return STAMP + HEADER_V2 + len(self.payload) + CRC_SIZE

    def is_in(self, block: bytes, start: int) -> bool:
        """Return whether the record at `start` has this payload."""
        return block.startswith(self.payload, start + STAMP + HEADER_V2)


class Findings:
    """Collected in the order of the file."""

    def __init__(self) -> None:
        self.finder = EventFinder()
        self.speed = Buckets()
        self.demand = Buckets()
        """Largest axis of the driver's demand, 0..1."""
        self.damage = Buckets(operator.add)
        """Bytes that belong to no valid record."""
        self.lost = Buckets(operator.add)
        """Packet numbers that are missing."""
        self.plans = PlanHistory()
        self.kept = array("Q")
        """Offsets of the messages of KEPT."""
        self._params: dict[tuple[int, int, bytes], tuple[array[int], bytes]] = {}
        """System, component and name -> offsets of the changes of a parameter, and its newest payload."""
        self._beats: dict[tuple[int, int], bytes] = {}
        """System and component -> its newest HEARTBEAT."""
        self.beats: dict[SourceKey, KnownBeat] = {}
        """The same, for a scan that compares bytes."""
        self._damages = 0
        self._damage: tuple[LogEvent, int] | None = None
        """The newest one, and the offset behind it."""

    @staticmethod
    def wants(message_id: int) -> bool:
        """Return whether messages of this id hold findings."""
        return message_id in EVENT_IDS or message_id in KEPT or message_id in _OTHERS

    def add(self, time: float, frame: LogFrame) -> None:
        """Handle a valid frame."""
        number = frame.message_id
        payload = payload_of(frame.raw)
        if number in KEPT and len(self.kept) < MAX_KEPT:
            self.kept.append(frame.at)
        if number in EVENT_IDS:
            self._add_event(time, frame, payload)
        elif number in _OTHERS:
            _OTHERS[number](self, time, frame, payload)

    def _add_event(self, time: float, frame: LogFrame, payload: bytes) -> None:
        """Look for events in a message. Most are repeated HEARTBEATs, which are not decoded again."""
        number, system, component = frame.message_id, frame.system, frame.component
        if number == m.Heartbeat.id:
            if self._beats.get((system, component)) == payload and self.finder.repeat(system, component, time):
                return
            self._beats[system, component] = payload
            key = bytes((system, component, 0, 0, 0))
            self.beats.pop(key, None)
            if frame.raw[0] == MAGIC_V2 and not frame.raw[2]:
                self.beats[key] = KnownBeat(frame.raw[:3], payload, system, component)
        elif number == m.StatusText.id and self.finder.events.leaves_out(int.from_bytes(payload[:1])):
            return
        self.finder.handle(Found(time, frame.at, system, component, decode(number, payload)))

    def repeat_beat(self, beat: KnownBeat, time: float) -> bool:
        """Handle a HEARTBEAT that came again as it was. Returns False if that is an event, and the frame is needed."""
        return self.finder.repeat(beat.system, beat.component, time)

    def _add_speed(self, time: float, frame: LogFrame, payload: bytes) -> None:
        (speed,) = _SPEED.unpack(payload[4:8].ljust(4, b"\0"))
        if math.isfinite(speed):
            self.speed.add(time, abs(speed))

    def _add_plan(self, time: float, frame: LogFrame, payload: bytes) -> None:
        for change in self.plans.add(frame, self.finder.vehicles):
            if change.sent:
                self.finder.events.add(LogEvent(time, frame.at, "PLAN", Severity.INFO, describe(change), change.system))

    def _add_param(self, time: float, frame: LogFrame, payload: bytes) -> None:
        payload = payload.ljust(25, b"\0")
        key = (frame.system, frame.component, payload[_NAME])
        offsets, before = self._params.get(key, (array("Q"), b""))
        if payload != before and (offsets or len(self._params) < MAX_PARAMS):
            offsets.append(frame.at)
            self._params[key] = offsets, payload

    def _add_demand(self, time: float, frame: LogFrame, payload: bytes) -> None:
        message: Any = decode(frame.message_id, payload)
        target = message.target if isinstance(message, m.ManualControl) else message.target_system
        vehicle = self.finder.vehicles.get(target)
        if vehicle is not None:
            axes = parse_axes(message, axis_map(vehicle.autopilot, vehicle.kind)) or NEUTRAL
            self.demand.add(time, max(map(abs, (axes.throttle, axes.steering, axes.side, axes.climb))))

    def params_before(self, offset: int) -> list[int]:
        """Return the offsets of the newest value of each parameter before an offset."""
        found = []
        for offsets, _ in self._params.values():
            if at := bisect_left(offsets, offset):
                found.append(offsets[at - 1])
        return found

    def kept_before(self, offset: int, count: int) -> list[int]:
        """Return the offsets of the newest messages of KEPT before an offset."""
        at = bisect_left(self.kept, offset)
        return list(self.kept[max(0, at - count) : at])

    def add_damage(self, time: float, offset: int, size: int) -> None:
        """Note bytes that belong to no valid record."""
        self.damage.add(time, size)
        before, events = self._damage, self.finder.events
        if before is not None and before[1] == offset:  # it goes on in the next interval
            size += offset - before[0].offset
            events.replace(before[0], event := _damage_event(before[0].time, before[0].offset, size))
        else:
            self._damages += 1
            event = _damage_event(time, offset, size)
            if self._damages <= MAX_DAMAGE_EVENTS:
                events.add(event)
        self._damage = event, event.offset + size

    def add_jump(self, time: float, offset: int) -> None:
        """Note that the recorded clock jumped."""
        self.finder.events.add(LogEvent(time, offset, "CLOCK", Severity.WARNING, "the recorded clock jumps here"))


def _damage_event(time: float, offset: int, size: int) -> LogEvent:
    return LogEvent(time, offset, "DAMAG", Severity.ERROR, f"{size} bytes left out: no valid record")


_OTHERS: dict[int, Callable[[Findings, float, LogFrame, bytes], None]] = {
    m.VfrHud.id: Findings._add_speed,
    m.ParamValue.id: Findings._add_param,
    m.ManualControl.id: Findings._add_demand,
    m.RoverOperatorPresence.id: Findings._add_demand,
    **dict.fromkeys(PLAN_IDS, Findings._add_plan),
}
