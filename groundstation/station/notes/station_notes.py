"""StationNotes: what the operator and this station do, as ROVER_STATION_EVENTs for the telemetry log."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

from dialects.axes import NEUTRAL, Axes
from dialects.enums import Severity
from dialects.enums import StationEventKind as Kind
from dialects.messages import RoverStationEvent, encode_text
from dialects.printable import printable
from groundstation.intents.base import Intent
from groundstation.intents.driving import DriveKeyDown, DriveKeyUp, ReleasePad, SetStyle, StepLimits, Stop
from groundstation.intents.services import ServiceIntent
from groundstation.intents.session import ReportScreen, SetKeyGate
from groundstation.station.driving.operator import OperatorSession
from groundstation.station.driving.permission import Permission
from groundstation.vehicles.fleet import Fleet
from groundstation.vehicles.state.message_log import OPERATOR, STATE
from link.core import LinkReport

TEXT_SIZE = 100
"""Bytes of the field `text`."""

REPEATED_WITHIN = 1.0
"""s within which the same decision is not noted again: a key that does not count may repeat 30 times a second."""

NoteSink = Callable[[float, RoverStationEvent], None]


class StationNotes:
    """Follows the keys, the screen, the vehicle, the links and the message log; notes only changes."""

    def __init__(self, operator: OperatorSession, fleet: Fleet) -> None:
        self.sink: NoteSink | None = None
        """Takes the notes with their times; None: nobody records."""
        self._operator = operator
        self._fleet = fleet
        self._held: tuple[str, ...] = ()
        self._overrides = False
        self._axes = NEUTRAL
        self._vehicle = 0
        self._blocked: str | None = ""
        self._links: dict[int, str] = {}
        self._decided: tuple[str, float] = ("", -math.inf)

    # ---- what the station calls ----

    def follow(self, intent: Intent | None, permission: Permission, now: float) -> None:
        """Note an intent that has been carried out, None for the time that has passed, and what has changed by it."""
        if self.sink is None:
            return
        if isinstance(intent, ReportScreen):
            self.add(now, Kind.SCREEN, intent.screen)
        elif isinstance(intent, StepLimits):
            self.add(now, Kind.ACTION, f"limits: speed {self._limit(0)}, turn {self._limit(1)}")
        elif isinstance(intent, ServiceIntent):
            self._add(now, Kind.REQUEST, intent.what, target=intent.system or self._vehicle)
        self._follow_vehicle(now)
        self._follow_keys(intent, permission, now)
        if permission.reason != self._blocked:
            reason = self._blocked = permission.reason
            self.add(now, Kind.DECISION, "keys drive" if reason is None else f"keys do not drive: {reason}")

    def observe(self, reports: Sequence[LinkReport], now: float) -> None:
        """Note which links were opened and closed; noticed once a second."""
        links = {report.index: report.name for report in reports}
        for index in [index for index in self._links if index not in links]:
            self.add(now, Kind.LINK_CLOSED, self._links[index])
        for index in [index for index in links if index not in self._links]:
            self.add(now, Kind.LINK_OPENED, links[index])
        self._links = links

    def add_line(self, now: float, label: str, text: str, severity: int) -> None:
        """Note a line of the message log, unless the log has it as a frame."""
        kind = self._kind(label, text)
        if kind is not None:
            self.add(now, kind, text, Severity(severity))

    def add(self, now: float, kind: Kind, text: str, severity: Severity = Severity.INFO) -> None:
        """Note something of the selected vehicle, or of none."""
        self._add(now, kind, text, severity, target=self._vehicle)

    # ---- changes ----

    def _follow_vehicle(self, now: float) -> None:
        selected = self._fleet.selected
        system = 0 if selected is None else selected.state.system
        if system != self._vehicle:
            self._vehicle = system
            self.add(now, Kind.VEHICLE_CHOSEN, selected.state.name if selected is not None else "none")

    def _follow_keys(self, intent: Intent | None, permission: Permission, now: float) -> None:
        """Note each key that begins or ends to count, and a latched demand that changes."""
        before, axes_before = self._held, self._axes
        self._held, self._axes = self._operator.sticks.held_keys(now), self._operator.sticks.axes(now)
        down, up = _without(self._held, before), _without(before, self._held)
        for key in up:
            self._add_key(now, Kind.KEYS_UP, f"{key}: {_why_up(intent, permission)}")
        for key in down:
            self._add_key(now, Kind.KEYS_DOWN, key)
        if (overrides := self._operator.sticks.overrides(now)) != self._overrides:
            self._overrides = overrides
            self.add(now, Kind.DECISION, f"limits before obstacles {'overridden' if overrides else 'count again'}")
        if isinstance(intent, DriveKeyDown):
            self._follow_press(intent, permission, now, noted=bool(down), changed=self._axes != axes_before)
        elif not down and not up and self._axes.neutral and not axes_before.neutral:
            self._add_key(now, Kind.KEYS_UP, _why_up(intent, permission))

    def _follow_press(
        self, push: DriveKeyDown, permission: Permission, now: float, *, noted: bool, changed: bool
    ) -> None:
        """Note a press that changes a latched demand, and one that does not count although the screen lets it pass.

        On other screens and in text fields the same keys are letters, which are no business of the log.
        """
        if noted or push.key in self._held:
            return
        if changed:
            self._add_key(now, Kind.KEYS_DOWN, push.key)
        elif permission.screen is None and (reason := self._operator.ignored(now)):
            self._decide(now, f"key {push.key} does not count: {reason}")

    def _decide(self, now: float, text: str) -> None:
        last, at = self._decided
        if text != last or now - at > REPEATED_WITHIN:
            self.add(now, Kind.DECISION, text)
        self._decided = (text, now)

    def _kind(self, label: str, text: str) -> Kind | None:
        if label in (OPERATOR, STATE, "station") and "control" in text:
            return Kind.CONTROL
        if label == "station" and text.startswith(tuple(f"{name}: " for name in self._links.values())):
            return Kind.LINK_FAULT
        if label == "station" and text.startswith("recording "):
            return Kind.MARK
        return {OPERATOR: Kind.ACTION, "ack": Kind.REQUEST, "station": Kind.DECISION}.get(label)

    # ---- notes ----

    def _limit(self, axis: int) -> str:
        sticks = self._operator.sticks
        return f"{100 * (sticks.throttle_limit, sticks.steering_limit)[axis]:.0f} %"

    def _add_key(self, now: float, kind: Kind, text: str) -> None:
        self._add(now, kind, text, target=self._vehicle, axes=self._axes)

    def _add(
        self,
        now: float,
        kind: Kind,
        text: str,
        severity: Severity = Severity.INFO,
        *,
        target: int,
        axes: Axes = NEUTRAL,
    ) -> None:
        if self.sink is not None:
            throttle, steering = round(1000 * axes.throttle), round(1000 * axes.steering)
            note = encode_text(printable(text), TEXT_SIZE)
            self.sink(now, RoverStationEvent(kind, severity, target, throttle, steering, note))


def _without(keys: Sequence[str], others: Sequence[str]) -> list[str]:
    return [key for key in keys if key not in others]


def _why_up(intent: Intent | None, permission: Permission) -> str:
    match intent:
        case DriveKeyUp() | ReleasePad():
            return "released"
        case Stop() | SetKeyGate():
            return intent.reason
        case DriveKeyDown():
            return f"{intent.key} in its place"
        case SetStyle():
            return "another drive style"
    return permission.reason or "no repeat"
