"""The one line that a driver must not miss: what is wrong, else what to do next. A table of rules."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from enum import Enum, auto

from groundstation.input.keymap import CONFIRM_KEY, Keymap
from groundstation.intents import OperatorAction
from groundstation.snapshot import Snapshot
from groundstation.ui.key_gate import GateClosure
from groundstation.ui.keynames import format_key, main_key

MAX_SILENCE = 99.0
"""s of silence that are still counted; after that it is simply gone."""


class AlertLevel(Enum):
    """How loud a line is."""

    HINT = auto()
    """What to do next."""
    WARNING = auto()
    """Something is in the way."""
    DANGER = auto()
    """A hand is needed now."""
    QUESTION = auto()
    """An answer is awaited."""


@dataclass(frozen=True, slots=True)
class Alert:
    """One line."""

    level: AlertLevel
    text: str


@dataclass(frozen=True, slots=True)
class AlertContext:
    """All that the rules look at."""

    snapshot: Snapshot
    keymap: Keymap
    closure: GateClosure | None = None
    question: OperatorAction | None = None
    station_alive: bool = True

    def key(self, action: str) -> str:
        """The key of an action, as it is written."""
        key = main_key(self.keymap, action)
        return "?" if key is None else format_key(key)


Rule = Callable[[AlertContext], Iterator[Alert]]


def active_alerts(situation: AlertContext) -> list[Alert]:
    """Every line that holds now, the most urgent first; never empty."""
    return [alert for rule in RULES for alert in rule(situation)]


def _station(now: AlertContext) -> Iterator[Alert]:
    if not now.station_alive:
        yield Alert(AlertLevel.DANGER, f"the station process has ended, nothing is sent: {now.key('app.quit')} quits")


def _emergency(now: AlertContext) -> Iterator[Alert]:
    vehicle = now.snapshot.vehicle
    if now.question is None and vehicle is not None and vehicle.emergency_stop:
        clear = f"{now.key('stop.clear')}, then {CONFIRM_KEY}, releases it"
        yield Alert(AlertLevel.DANGER, f"EMERGENCY STOP: the motors are off and locked. {clear}")


def _question(now: AlertContext) -> Iterator[Alert]:
    if now.question is not None:
        yield Alert(AlertLevel.QUESTION, f"{now.question.label}? {CONFIRM_KEY} = yes, any other key = no")


def _silence(now: AlertContext) -> Iterator[Alert]:
    vehicle = now.snapshot.vehicle
    if vehicle is not None and not vehicle.alive:
        silence = f"{vehicle.silence:.0f} s" if vehicle.silence < MAX_SILENCE else "minutes"
        yield Alert(AlertLevel.DANGER, f"no word from {vehicle.name} for {silence}: it stops by itself")


def _failsafe(now: AlertContext) -> Iterator[Alert]:
    vehicle = now.snapshot.vehicle
    if vehicle is not None and vehicle.failsafes and not vehicle.emergency_stop:
        soon = "" if vehicle.failsafe_in is None else f", next step in {vehicle.failsafe_in:.0f} s"
        yield Alert(AlertLevel.DANGER, f"failsafe: {', '.join(vehicle.failsafes)}{soon}")


def _gate(now: AlertContext) -> Iterator[Alert]:
    if now.closure is not None and now.question is None:
        yield Alert(AlertLevel.WARNING, f"keys do not drive: {now.closure.reason}")


def _refusal(now: AlertContext) -> Iterator[Alert]:
    vehicle = now.snapshot.vehicle
    if vehicle is not None and vehicle.refusal:
        yield Alert(AlertLevel.WARNING, vehicle.refusal)


LIMITS = {
    "neutral first": "neutral first: let go of all drive keys, then press again",
    "stale": "stale: the vehicle has no fresh command and stands",
    "fence": "the fence stops the vehicle here",
    "battery": "slowed down to spare the battery",
}
"""Limits of the vehicle that a driver must know, in words; others (slew, saturated) are everyday driving."""


def _limits(now: AlertContext) -> Iterator[Alert]:
    vehicle = now.snapshot.vehicle
    if vehicle is not None and vehicle.armed:
        for limit in vehicle.limits:
            if limit in LIMITS:
                yield Alert(AlertLevel.WARNING, LIMITS[limit])


def _driver(now: AlertContext) -> Iterator[Alert]:
    vehicle = now.snapshot.vehicle
    if vehicle is not None and not vehicle.in_control and (vehicle.driver or vehicle.armed):
        who = f"ground station {vehicle.driver} drives" if vehicle.driver else "you are not in control"
        yield Alert(AlertLevel.WARNING, f"{who}: {now.key('vehicle.control')} asks for control")


def _settings(now: AlertContext) -> Iterator[Alert]:
    for link in now.snapshot.links:
        if link.problem:
            yield Alert(AlertLevel.WARNING, f"{link.name}: {link.problem}")
    for warning in now.snapshot.vehicle.warnings if now.snapshot.vehicle else ():
        yield Alert(AlertLevel.WARNING, warning)


def _hint(now: AlertContext) -> Iterator[Alert]:
    vehicle, helm = now.snapshot.vehicle, now.snapshot.operator
    if vehicle is None:
        yield Alert(
            AlertLevel.HINT, f"no vehicle yet · {now.key('app.help')} shows the keys, {now.key('app.quit')} leaves"
        )
    elif not vehicle.armed:
        yield Alert(AlertLevel.HINT, f"disarmed: {now.key('vehicle.arm')}, then {CONFIRM_KEY}, arms {vehicle.name}")
    elif vehicle.mode != "MANUAL":
        yield Alert(
            AlertLevel.HINT, f"{vehicle.mode}: {now.key('vehicle.manual')} changes to MANUAL, where the keys drive"
        )
    elif not helm.gate_open and now.closure is None:
        yield Alert(AlertLevel.WARNING, f"keys do not drive: {helm.gate_reason}")
    elif helm.style == "latch" and (helm.throttle or helm.steering):
        yield Alert(AlertLevel.WARNING, f"it drives on by itself: {now.key('drive.stop')} or SPACE stops")
    else:
        verb = "hold" if helm.style == "hold" else "press"
        stops = f"SPACE stops, {now.key('stop.emergency')} cuts the motors"
        yield Alert(AlertLevel.HINT, f"{verb} {now.key('drive.forward')} to drive · {stops}")


RULES: tuple[Rule, ...] = (
    _station, _question, _emergency, _silence, _failsafe, _gate, _refusal, _limits, _driver, _settings, _hint,
)  # fmt: skip
"""The most urgent first."""
