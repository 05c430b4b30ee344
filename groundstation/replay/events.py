"""Events of a log: modes, arming, failsafes, texts, commands, keys, link losses; found while the index grows.

To find another kind of event, add a handler and its row in _HANDLERS.
"""

from __future__ import annotations

from bisect import bisect_left, bisect_right
from collections.abc import Callable, Iterator
from typing import Any, NamedTuple

import msgspec

from dialects import messages as m
from dialects.enum_names import enum_names
from dialects.enums import Command, Failsafe, ModeFlag, Severity, SystemState, VehicleType, result_name
from dialects.kinds import VehicleKind, find_kind
from dialects.messages import MESSAGES, Message, decode_text
from dialects.modes import custom_mode_of
from dialects.printable import printable
from groundstation.vehicles.readings.values import flag_words
from groundstation.vehicles.state.chunked_texts import TextJoiner
from groundstation.vehicles.state.vehicle_heartbeat import is_vehicle, replaces

MAX_EVENTS = 20_000
"""Kept; beyond that only those of severity WARNING and worse are, up to twice as many."""

MAX_TEXT = 120
"""Characters kept of a text."""

LOST_AFTER = 3.5
"""s between two HEARTBEATs of a vehicle after which its link was lost."""

COMMANDS = {
    Command.COMPONENT_ARM_DISARM: "arm",
    Command.DO_SET_MODE: "set mode",
    Command.MISSION_START: "start mission",
    Command.NAV_RETURN_TO_LAUNCH: "go home",
    Command.DO_REPOSITION: "go to",
    Command.DO_FLIGHTTERMINATION: "emergency stop",
    Command.PREFLIGHT_REBOOT_SHUTDOWN: "reboot",
    Command.DO_MOTOR_TEST: "motor test",
    Command.ACTUATOR_TEST: "motor test",
    Command.DO_SET_MISSION_CURRENT: "jump",
    Command.DO_PAUSE_CONTINUE: "pause or go on",
    Command.DO_CHANGE_SPEED: "change speed",
}
"""Commands that are events; the others (message intervals, requests) would bury them."""

STATION_EVENT = next((number for number, kind in MESSAGES.items() if kind.msgname == "ROVER_STATION_EVENT"), None)
"""Id of the message in which our ground station records its keys and decisions; None where the dialect lacks it."""


class LogEvent(NamedTuple):
    """What happened at one time."""

    time: float
    """s since the start of the log."""
    offset: int
    kind: str
    """A tag of at most five characters: MODE, ARM, FAIL, TEXT, CMD, ACK, KEY, ITEM, PLAN, LINK, CLOCK, GCS."""
    severity: int
    """MAV_SEVERITY."""
    text: str
    system: int = 0


class Found(NamedTuple):
    """A message that may be an event."""

    time: float
    offset: int
    system: int
    component: int
    message: Any


class EventList:
    """Events in the order of time."""

    def __init__(self) -> None:
        self._events: list[LogEvent] = []
        self.left_out = 0

    def __len__(self) -> int:
        return len(self._events)

    def __getitem__(self, at: int) -> LogEvent:
        return self._events[at]

    def __iter__(self) -> Iterator[LogEvent]:
        return iter(self._events)

    def add(self, event: LogEvent) -> None:
        """Add an event; one that is found late goes to its place in time."""
        if self.leaves_out(event.severity):
            return
        if self._events and event.time < self._events[-1].time:
            self._events.insert(self.place(event.time, after=True), event)
        else:
            self._events.append(event)

    def replace(self, old: LogEvent, new: LogEvent) -> None:
        """Put an event in the place of one of the same time; nothing if that was left out."""
        for at in range(self.place(old.time), self.place(old.time, after=True)):
            if self._events[at] is old:
                self._events[at] = new

    def leaves_out(self, severity: int) -> bool:
        """Return whether the list is too full for an event of a severity, which then counts as left out."""
        full = len(self._events) >= (MAX_EVENTS if severity > Severity.WARNING else 2 * MAX_EVENTS)
        self.left_out += full
        return full

    def place(self, time: float, *, after: bool = False) -> int:
        """Return how many events are before `time`; with `after` also those at it."""
        search = bisect_right if after else bisect_left
        return search(self._events, time, key=lambda event: event.time)

    def slice(self, first: int, count: int) -> tuple[LogEvent, ...]:
        """Return some of them."""
        return tuple(self._events[first : first + count])


class _Vehicle(msgspec.Struct):
    """What was last heard of a vehicle."""

    found: float
    heard: float
    autopilot: int
    kind: int
    """MAV_TYPE."""
    model: VehicleKind
    mode: str = ""
    armed: bool = False
    status: int = SystemState.UNINIT
    failsafes: int = 0
    component: int = 0
    """Of its HEARTBEATs."""


class EventFinder(msgspec.Struct):
    """Turns messages into events."""

    events: EventList = msgspec.field(default_factory=EventList)
    stations: set[tuple[int, int]] = msgspec.field(default_factory=set)
    """Ground stations: system and component."""
    vehicles: dict[int, _Vehicle] = msgspec.field(default_factory=dict)
    beating: dict[tuple[int, int], _Vehicle] = msgspec.field(default_factory=dict)
    """System and component -> the vehicle that its HEARTBEATs are of."""

    joiner: TextJoiner = msgspec.field(default_factory=TextJoiner)

    def handle(self, found: Found) -> None:
        """Add the events of one message."""
        handler = _HANDLERS.get(type(found.message))
        if handler is None and type(found.message).id == STATION_EVENT:
            handler = _station_event
        for kind, severity, text in handler(self, found) if handler else ():
            self.events.add(
                LogEvent(found.time, found.offset, kind, severity, printable(text)[:MAX_TEXT], found.system)
            )

    def repeat(self, system: int, component: int, time: float) -> bool:
        """Note that a HEARTBEAT came again as it was. Returns False if that is an event: after a silence."""
        vehicle = self.beating.get((system, component))
        if vehicle is not None and time - vehicle.heard > LOST_AFTER:
            return False
        if vehicle is not None:
            vehicle.heard = time
        return True


Parts = Iterator[tuple[str, int, str]]
"""Kind, severity and text of events."""


def _heartbeat(finder: EventFinder, found: Found) -> Parts:
    beat: m.Heartbeat = found.message
    finder.beating.pop((found.system, found.component), None)
    if beat.type == VehicleType.GCS:
        finder.stations.add((found.system, found.component))
    known = finder.vehicles.get(found.system)
    if not is_vehicle(beat) or (known is not None and not _speaks_for(found.component, known)):
        return
    model = find_kind(beat.autopilot, beat.type)
    mode, armed = model.mode_name(beat.custom_mode), bool(beat.base_mode & ModeFlag.ARMED)
    if known is None or known.component != found.component:
        finder.vehicles[found.system] = _Vehicle(
            found.time, found.time, beat.autopilot, beat.type, model, mode, armed, beat.system_status,
            component=found.component,
        )  # fmt: skip
        finder.beating[found.system, found.component] = finder.vehicles[found.system]
        yield "MODE", Severity.INFO, mode
        if armed:
            yield "ARM", Severity.NOTICE, "armed"
        return
    finder.beating[found.system, found.component] = known
    yield from _changes(known, found.time - known.heard, mode, armed=armed)
    if beat.system_status != known.status and beat.system_status in _BAD_STATES:
        yield "FAIL", Severity.CRITICAL, f"system status {SystemState(beat.system_status).name}"
    known.heard, known.mode, known.armed, known.status = found.time, mode, armed, beat.system_status


def _speaks_for(component: int, known: _Vehicle) -> bool:
    """Return whether a component that sends HEARTBEATs of a vehicle is this one, or the autopilot in its place."""
    return component == known.component or replaces(component, known.component)


_BAD_STATES = (SystemState.CRITICAL, SystemState.EMERGENCY)


def _changes(known: _Vehicle, silence: float, mode: str, *, armed: bool) -> Parts:
    if silence > LOST_AFTER:
        yield "LINK", Severity.CRITICAL, f"no heartbeat for {silence:.1f} s before"
    if mode != known.mode:
        yield "MODE", Severity.NOTICE, f"{known.mode} → {mode}"
    if armed != known.armed:
        yield "ARM", Severity.NOTICE, "armed" if armed else "disarmed"


def _status_text(finder: EventFinder, found: Found) -> Parts:
    """Yield a text. One in chunks becomes an event with its first chunk, which each later one completes."""
    message: m.StatusText = found.message
    text = finder.joiner.add(message, found.system, found.component, found.time)
    if message.id == 0:
        yield "TEXT", text.severity, text.text
        return
    for _ in finder.joiner.pop_overdue(found.time):
        pass  # their events are there already
    if text.made is None:
        text.made = LogEvent(found.time, found.offset, "TEXT", text.severity, text.text[:MAX_TEXT], found.system)
        finder.events.add(text.made)
    else:
        before, text.made = text.made, text.made._replace(text=text.text[:MAX_TEXT])
        finder.events.replace(before, text.made)


def _failsafe(finder: EventFinder, found: Found) -> Parts:
    known, active = finder.vehicles.get(found.system), int(found.message.active)
    if known is None or active == known.failsafes:
        return
    begun, ended = active & ~known.failsafes, known.failsafes & ~active
    known.failsafes = active
    if begun:
        yield "FAIL", Severity.CRITICAL, f"failsafe {', '.join(flag_words(Failsafe, begun))}"
    if ended:
        yield "FAIL", Severity.NOTICE, f"failsafe over: {', '.join(flag_words(Failsafe, ended))}"


def _command(finder: EventFinder, found: Found) -> Parts:
    message = found.message
    name = COMMANDS.get(message.command)
    if name is None:
        return
    if message.command == Command.COMPONENT_ARM_DISARM:
        name = "arm" if message.param1 else "disarm"
    elif message.command == Command.DO_SET_MODE:
        known = finder.vehicles.get(message.target_system)
        number = (
            None if known is None else custom_mode_of(message.param1, message.param2, message.param3, known.autopilot)
        )
        name = name if known is None or number is None else f"set mode {known.model.mode_name(number)}"
    yield "CMD", Severity.INFO, name


def _ack(finder: EventFinder, found: Found) -> Parts:
    name = COMMANDS.get(found.message.command)
    if name is not None:
        result = int(found.message.result)
        severity = Severity.INFO if result in (0, 5) else Severity.WARNING
        yield "ACK", severity, f"{name}: {result_name(result)}"


def _reached(finder: EventFinder, found: Found) -> Parts:
    yield "ITEM", Severity.INFO, f"item {found.message.seq} reached"


def _station_event(finder: EventFinder, found: Found) -> Parts:
    message = found.message
    kind = enum_names("ROVER_STATION_EVENT_KIND").get(int(message.kind), "")
    if kind == "SCREEN":
        return  # which screen was looked at is no event of a drive
    tag = "KEY" if kind.startswith("KEYS") else "CMD" if kind == "ACTION" else "LINK" if "LINK" in kind else "GCS"
    yield tag, int(message.severity), decode_text(message)


_HANDLERS: dict[type[Message], Callable[[EventFinder, Found], Parts]] = {
    m.Heartbeat: _heartbeat,
    m.StatusText: _status_text,
    m.RoverFailsafeStatus: _failsafe,
    m.CommandLong: _command,
    m.CommandInt: _command,
    m.CommandAck: _ack,
    m.MissionItemReached: _reached,
}
"""Message -> what turns it into events."""

EVENT_IDS = frozenset({*(kind.id for kind in _HANDLERS), *([] if STATION_EVENT is None else [STATION_EVENT])})
"""Ids of the messages that may be events."""
