"""Alert rules: what is wrong, most urgent first."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from enum import Enum, auto

import msgspec

from groundstation.snapshot import EmergencyProgress, VehicleView
from groundstation.snapshot.lease import NO_SCREEN
from groundstation.ui.display.agent_texts import hold_text, proposal_text
from groundstation.ui.display.display_state import DisplayState
from groundstation.ui.keys.key_gate import OTHER_SCREEN, TEXT_FIELD

MAX_SILENCE = 99.0
"""s without a heartbeat that are still counted; after that the text is "minutes"."""


class AlertLevel(Enum):
    """Urgency of an alert."""

    WARNING = auto()
    """Something keeps the vehicle from driving."""
    DANGER = auto()
    """The operator must act now."""
    QUESTION = auto()
    """A key is held to confirm an action."""


class Alert(msgspec.Struct, frozen=True):
    """One line of text."""

    level: AlertLevel
    text: str


Rule = Callable[[DisplayState], Iterator[Alert]]


def active_alerts(now: DisplayState) -> list[Alert]:
    """Return every alert that applies now, most urgent first."""
    rules = RULES if now.snapshot.replay is None else REPLAY_RULES
    return [alert for rule in rules for alert in rule(now)]


def _station(now: DisplayState) -> Iterator[Alert]:
    quits = "" if now.station_alive else f"; {now.key('app.quit')} quits"
    if now.outage:
        yield Alert(AlertLevel.DANGER, f"{now.outage}{quits}")
    elif not now.station_alive:
        yield Alert(AlertLevel.DANGER, f"station process ended: nothing is sent{quits}")


def _emergency(now: DisplayState) -> Iterator[Alert]:
    vehicle = now.snapshot.vehicle
    if now.snapshot.blind_stop:
        yield Alert(AlertLevel.DANGER, now.snapshot.blind_stop)
    if now.hold is None and vehicle is not None and vehicle.emergency_stop:
        clear = f"Hold {now.key('stop.clear')} to release it"
        yield Alert(AlertLevel.DANGER, emergency_text(vehicle, clear))


_PROGRESS = {
    EmergencyProgress.SENT: "sent, waiting for an answer",
    EmergencyProgress.UNANSWERED: "sent, NOT acknowledged",
    EmergencyProgress.REFUSED: "REFUSED by the vehicle",
    EmergencyProgress.ACCEPTED: "acknowledged",
}


def emergency_text(vehicle: VehicleView, clear: str) -> str:
    """Return what is known of an emergency stop: only what the vehicle has confirmed is claimed."""
    progress = vehicle.emergency_progress
    request = "on" if progress is None else _PROGRESS[progress]
    if vehicle.stop_doubt and (vehicle.duplicates or not vehicle.armed):
        return f"EMERGENCY STOP {request}, but {vehicle.stop_doubt}"
    if vehicle.armed:
        return f"EMERGENCY STOP {request}, but the vehicle {_reports(vehicle)} ARMED"
    if progress is None:
        return f"EMERGENCY STOP: the motors are off and locked. {clear}"
    if progress is EmergencyProgress.ACCEPTED:
        return f"EMERGENCY STOP acknowledged, disarmed. {clear}"
    return f"EMERGENCY STOP {request}; the vehicle {_reports(vehicle)} disarmed"


def _reports(vehicle: VehicleView) -> str:
    return "reports" if vehicle.alive else "last reported"


def _hold(now: DisplayState) -> Iterator[Alert]:
    if now.hold is not None:
        yield Alert(AlertLevel.QUESTION, hold_text(now.hold, now.snapshot.vehicle))


def _proposal(now: DisplayState) -> Iterator[Alert]:
    if now.snapshot.proposal is not None and now.hold is None:
        yield Alert(AlertLevel.QUESTION, proposal_text(now))


def _stop_question(now: DisplayState) -> Iterator[Alert]:
    vehicle = now.snapshot.vehicle
    if vehicle is not None and vehicle.stop_question is not None:
        text = f"{vehicle.name} is in the air and falls without power: {now.key('stop.emergency')} again cuts it"
        yield Alert(AlertLevel.QUESTION, f"{text} ({vehicle.stop_question:.0f} s)")


def handover_text(now: DisplayState) -> str:
    """Return the request of another screen or ground station with the keys that answer it; "" without one."""
    notice, lease = now.snapshot.handover, now.snapshot.lease
    if lease.asks:
        return f"{lease.asks} asks to drive: {_answers(now, lease.left)}"
    if notice is None:
        return ""
    return f"GCS {notice.station} requests control of {notice.vehicle}: {_answers(now, notice.left)}"


def _answers(now: DisplayState, left: float) -> str:
    return f"{now.key('vehicle.give')} gives, {now.key('vehicle.keep')} keeps ({left:.0f} s)"


def _handover(now: DisplayState) -> Iterator[Alert]:
    if text := handover_text(now):
        yield Alert(AlertLevel.QUESTION, text)


def _silence(now: DisplayState) -> Iterator[Alert]:
    vehicle = now.snapshot.vehicle
    if vehicle is not None and not vehicle.alive:
        silence = f"{vehicle.silence:.0f} s" if vehicle.silence < MAX_SILENCE else "minutes"
        stops = vehicle.link_loss_action or "not known whether it stops"
        if vehicle.emergency_progress in (EmergencyProgress.SENT, EmergencyProgress.UNANSWERED):
            stops = "EMERGENCY STOP NOT acknowledged"
        yield Alert(AlertLevel.DANGER, f"no heartbeat from {vehicle.name} for {silence}: {stops}")


DRIFTING = ("ALT_HOLD", "ALTCTL")
"""Modes that hold the altitude and not the place."""
FIX_3D = 3


def _flight(now: DisplayState) -> Iterator[Alert]:
    """Yield what a pilot must know of a vehicle in the air."""
    vehicle = now.snapshot.vehicle
    if vehicle is None or not (vehicle.flies and vehicle.may_fall):
        return
    if vehicle.gps_fix is not None and vehicle.gps_fix < FIX_3D:
        yield Alert(AlertLevel.DANGER, f"{vehicle.name} has lost its GPS fix: it may drift, land it")
    for line in vehicle.health:
        if line.good is False and line.name == "estimate":
            yield Alert(AlertLevel.DANGER, f"{vehicle.name}: {line.name} {line.text}: land it")
    yield from _drift(vehicle, now)


def _drift(vehicle: VehicleView, now: DisplayState) -> Iterator[Alert]:
    """Yield that it does not stay where it is: one mode does not hold the place, and in the others the wind wins."""
    at = "" if vehicle.drift is None else f" at {vehicle.drift:.1f} m/s"
    if vehicle.mode in DRIFTING:
        holds = f"{now.key('vehicle.manual')} holds the place"
        yield Alert(AlertLevel.WARNING, f"{vehicle.mode} drifts with the wind{at}: {holds}")
    elif at:
        yield Alert(AlertLevel.DANGER, f"no key held, and it drifts{at}: it does not hold its place")


def _failsafe(now: DisplayState) -> Iterator[Alert]:
    vehicle = now.snapshot.vehicle
    if vehicle is not None and vehicle.failsafes and not vehicle.emergency_stop:
        soon = "" if vehicle.failsafe_in is None else f", next step in {vehicle.failsafe_in:.0f} s"
        yield Alert(AlertLevel.DANGER, f"failsafe: {', '.join(vehicle.failsafes)}{soon}")


def _breach(now: DisplayState) -> Iterator[Alert]:
    vehicle = now.snapshot.vehicle
    if vehicle is not None and vehicle.breach:
        level = AlertLevel.DANGER if vehicle.armed else AlertLevel.WARNING
        how = "" if vehicle.drivable else f", {now.key('vehicle.manual')} changes to {vehicle.keys_mode}"
        verb = "fly" if vehicle.flies else "drive"
        yield Alert(level, f"{vehicle.name} is {vehicle.breach} ({vehicle.mode}): {verb} it back{how}")


STATES = {5: "CRITICAL (a failsafe or fault)", 6: "EMERGENCY"}
"""MAV_STATE of the HEARTBEAT that a driver must know -> its text."""


def _state(now: DisplayState) -> Iterator[Alert]:
    vehicle = now.snapshot.vehicle
    if vehicle is None or vehicle.emergency_stop or vehicle.failsafes or vehicle.status not in STATES:
        return
    level = AlertLevel.DANGER if vehicle.armed else AlertLevel.WARNING
    yield Alert(level, f"{vehicle.name} reports {STATES[vehicle.status]}: see the log for the reason")


def _gate(now: DisplayState) -> Iterator[Alert]:
    lease = now.snapshot.lease
    if lease.driver == NO_SCREEN:
        takes = f"{now.key('vehicle.control')} takes the keys"
        yield Alert(AlertLevel.WARNING, f"you watch: {NO_SCREEN} drives, a program may; {takes}, stops work")
    elif lease.driver:
        request = f"asked ({lease.waits:.0f} s)" if lease.waits is not None else f"{now.key('vehicle.control')} asks"
        yield Alert(AlertLevel.WARNING, f"you watch: {lease.driver} drives; {request}, stops work")
    elif now.closure is not None and now.closure.reason not in _ELSEWHERE:
        yield Alert(AlertLevel.WARNING, f"keys do not drive: {now.closure.reason}")


def _key(now: DisplayState) -> Iterator[Alert]:
    if now.key_hint is not None:
        yield Alert(AlertLevel.WARNING, now.key_hint)


def _refusal(now: DisplayState) -> Iterator[Alert]:
    vehicle = now.snapshot.vehicle
    if vehicle is not None and vehicle.refusal and vehicle.control_wait is None:
        yield Alert(AlertLevel.WARNING, vehicle.refusal)


LIMITS = {
    "neutral first": "neutral first: release all drive keys, then press again",
    "stale": "stale: the vehicle has no recent command and has stopped",
    "fence": "the fence stops the vehicle here",
    "battery": "speed reduced: battery low",
    "obstacle": "speed reduced: obstacle ahead of the motion; driving away from it is free",
    "range sensor": "speed reduced: a range sensor has failed, see the log for which",
    "freshness": "speed reduced: commands arrive late or get lost (FRESH_DIST)",
}
"""Limits of the vehicle that a driver must know -> their text. The others (slew, saturated) are normal driving."""


def _limits(now: DisplayState) -> Iterator[Alert]:
    vehicle = now.snapshot.vehicle
    if vehicle is not None and vehicle.armed:
        for limit in vehicle.limits:
            if limit in LIMITS and (limit != "neutral first" or _driven_by_keys(vehicle)):
                yield Alert(AlertLevel.WARNING, LIMITS[limit])


def _driven_by_keys(vehicle: VehicleView) -> bool:
    """Return whether our keys are what moves the vehicle: elsewhere their release changes nothing."""
    return vehicle.in_control and vehicle.obeys_keys


def _id_conflict(now: DisplayState) -> Iterator[Alert]:
    if now.snapshot.id_conflict:
        yield Alert(AlertLevel.WARNING, now.snapshot.id_conflict)


def _duplicates(now: DisplayState) -> Iterator[Alert]:
    vehicle = now.snapshot.vehicle
    if vehicle is not None and vehicle.duplicates:
        text = f"system id {vehicle.system} is used by several vehicles: {vehicle.duplicates}"
        yield Alert(AlertLevel.DANGER, text)


def _obeys(now: DisplayState) -> Iterator[Alert]:
    vehicle = now.snapshot.vehicle
    if vehicle is not None and vehicle.obeys:
        yield Alert(AlertLevel.WARNING, vehicle.obeys)


def _driver(now: DisplayState) -> Iterator[Alert]:
    vehicle = now.snapshot.vehicle
    if vehicle is None or vehicle.undriven:
        return
    if not vehicle.in_control and (vehicle.driver or vehicle.armed):
        if vehicle.duplicate_gcs:
            text = f"another program with our id {vehicle.driver} drives: start with --system {now.snapshot.free_id}"
            yield Alert(AlertLevel.WARNING, text)
            return
        who = f"ground station {vehicle.driver} drives" if vehicle.driver else "you are not in control"
        asks = f"{now.key('vehicle.control')} requests control"
        if now.away is not None:
            who = f"tmux was detached for {now.away:.0f} s, control was released"
        if vehicle.control_wait is not None:
            asks = f"control requested, {vehicle.control_wait:.0f} s to answer"
        yield Alert(AlertLevel.WARNING, f"{who}: {asks}")


_ELSEWHERE = (OTHER_SCREEN.reason, TEXT_FIELD.reason)
"""Why a key was ignored that was text or a key of another screen: nothing has to be released."""


def _operator(now: DisplayState) -> Iterator[Alert]:
    vehicle, operator = now.snapshot.vehicle, now.snapshot.operator
    if vehicle is None or not vehicle.armed or not _driven_by_keys(vehicle):
        return
    if operator.held_over:
        yield Alert(AlertLevel.WARNING, "keys do not drive: one is held from before; release it, then press again")
    elif not operator.gate_open and now.closure is None:
        yield Alert(AlertLevel.WARNING, f"keys do not drive: {operator.gate_reason}")
    elif operator.ignored and operator.ignored not in _ELSEWHERE:
        yield Alert(AlertLevel.WARNING, f"key ignored ({operator.ignored}): release it, then press again")
    elif operator.overrides:
        yield Alert(AlertLevel.WARNING, f"OBSTACLES OVERRIDDEN while {now.key('drive.override')} is held")
    elif operator.style == "latch" and operator.moves:
        yield Alert(AlertLevel.WARNING, f"latched, the vehicle keeps driving: {now.key('drive.stop')} or SPACE stops")


def _gamepad(now: DisplayState) -> Iterator[Alert]:
    if now.gamepad is not None and now.gamepad.alert:
        yield Alert(AlertLevel.WARNING, now.gamepad.alert)


def _settings(now: DisplayState) -> Iterator[Alert]:
    for link in now.snapshot.links:
        if link.problem:
            yield Alert(AlertLevel.WARNING, f"{link.name}: {link.problem}")
    if now.snapshot.signing is not None and now.snapshot.signing.alarm:
        yield Alert(AlertLevel.WARNING, now.snapshot.signing.alarm)
    for warning in now.snapshot.vehicle.warnings if now.snapshot.vehicle else ():
        yield Alert(AlertLevel.WARNING, warning)


def _watched(now: DisplayState) -> Iterator[Alert]:
    vehicle = now.snapshot.vehicle
    links = [link for link in now.snapshot.links if vehicle is not None and vehicle.system in link.systems]
    if vehicle is not None and links and all(link.watch_only for link in links):
        yield Alert(AlertLevel.WARNING, f"{vehicle.name} is only watched: nothing is sent on {links[0].name}")


def _recording(now: DisplayState) -> Iterator[Alert]:
    recording = now.snapshot.recording
    if recording is not None and recording.problem:
        yield Alert(AlertLevel.WARNING, recording.problem)


def _vehicles(now: DisplayState) -> Iterator[Alert]:
    further = now.snapshot.not_shown
    if further:
        what = "1 more vehicle is" if further == 1 else f"{further} more vehicles are"
        yield Alert(AlertLevel.WARNING, f"{what} not shown: the limit is {len(now.snapshot.vehicles)}")


RULES: tuple[Rule, ...] = (
    _station, _hold, _stop_question, _proposal, _silence, _emergency, _failsafe, _breach, _flight, _handover,
    _duplicates, _state, _key, _gate, _obeys, _operator, _driver, _gamepad, _refusal, _id_conflict, _limits, _watched,
    _settings, _recording, _vehicles,
)  # fmt: skip
"""Most urgent first."""

REPLAY_RULES: tuple[Rule, ...] = (_station, _silence, _emergency, _failsafe, _breach, _state)
"""Those that tell what was so in the log; the others say what to do now."""
