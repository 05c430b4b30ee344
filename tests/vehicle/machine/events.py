"""The events that are tried in every state."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

from dialects.enums import Command
from dialects.modes import Mode
from tests.vehicle.machine.rig import AHEAD, NEUTRAL, Rig

Event = Callable[[Rig], None]
ARM, SWITCH = Command.COMPONENT_ARM_DISARM, Command.DO_SET_SAFETY_SWITCH_STATE
CONTROL = Command.REQUEST_OPERATOR_CONTROL


def _command(name: str, act: str, *words: float) -> Event:
    return lambda rig: rig.command(name, act, int(words[0]), *words[1:])


def _demand(name: str, **options: float) -> dict[str, Event]:
    return {
        f"{name} neutral": lambda rig: rig.demand(name, NEUTRAL, **options),
        f"{name} ahead": lambda rig: rig.demand(name, AHEAD, **options),
    }


def station(name: str) -> dict[str, Event]:
    """Return what a ground station may do, wherever control is."""
    return {
        f"{name} arms": _command(name, "arm", ARM, 1),
        f"{name} requests": _command(name, "request", CONTROL, 1),
        f"{name} releases": _command(name, "release", CONTROL, 0),
        **_demand(name),
    }


DISARM: dict[str, Event] = {"a stranger disarms": _command("S", "disarm", ARM, 0)}
STOP: dict[str, Event] = {"a stranger stops": _command("S", "estop", SWITCH, 0)}
HOLD: dict[str, Event] = {"a stranger holds": lambda rig: rig.mode("S", Mode.HOLD)}
SILENCE: dict[str, Event] = {
    "cycle": lambda rig: rig.cycle(),
    "0.54 s of silence": lambda rig: rig.wait(0.54),
    "2.25 s of silence": lambda rig: rig.wait(2.25),
}
LATE: dict[str, Event] = {
    "a late cycle": lambda rig: rig.cycle(0.15),
    "a very late cycle": lambda rig: rig.cycle(0.3),
}

OLD: dict[str, Event] = {
    "A sends an old neutral": lambda rig: rig.demand("A", NEUTRAL, age=1.0),
    "A sends an old ahead": lambda rig: rig.demand("A", AHEAD, age=1.0),
    "A sends ahead without a proof": lambda rig: rig.unproven("A", AHEAD),
    "A sends neutral without a proof": lambda rig: rig.unproven("A", NEUTRAL),
}


def _mode(name: str, mode: Mode) -> dict[str, Event]:
    return {f"{name} chooses {mode.name}": lambda rig: rig.mode(name, mode)}


TAKEOVER: dict[str, Event] = {"A lets others take over": _command("A", "request", CONTROL, 1, 1)}

TWINS: dict[str, Event] = {
    **station("A"), **station("T"), **_mode("T", Mode.MANUAL), **DISARM, **SILENCE, **OLD,
}  # fmt: skip
"""Two programs with the same ids, and a stranger."""
RIVALS: dict[str, Event] = {
    **station("A"), **station("B"), **_mode("B", Mode.MANUAL), **TAKEOVER, **DISARM, **SILENCE,
}  # fmt: skip
"""Two ground stations, and a stranger."""
ALL_THREE: dict[str, Event] = {**TWINS, **RIVALS, **HOLD, **_mode("A", Mode.MANUAL)}


def _prove_and_arm(act: str, *words: float) -> Event:
    """Return an arming as our ground station does it: with a proof of its session just before."""

    def arm(rig: Rig) -> None:
        rig.demand("A", NEUTRAL)
        rig.command("A", act, ARM, 1, *words)

    return arm


DRIVER: dict[str, Event] = {
    "A arms": _prove_and_arm("arm"),
    "A releases": _command("A", "release", CONTROL, 0),
    **_demand("A"), **_mode("A", Mode.MANUAL),
}  # fmt: skip

SHORT: dict[str, Event] = {name: SILENCE[name] for name in ("cycle", "0.54 s of silence")}

STOPS: dict[str, Event] = {
    **DRIVER, **DISARM, **STOP, **HOLD, **SHORT,
    "a stranger terminates": _command("S", "terminate", Command.DO_FLIGHTTERMINATION, 1),
    "A releases the stop": _command("A", "unstop", SWITCH, 1),
    "B releases the stop": _command("B", "unstop", SWITCH, 1),
    "the button is pressed": partial(Rig.button, pressed=True),
    "the button is released": partial(Rig.button, pressed=False),
}  # fmt: skip
"""The emergency stop, and how it is left."""

FAULTS: dict[str, Event] = {
    **DRIVER, **DISARM, **SHORT, **LATE,
    "A arms by force": _prove_and_arm("force", 21196),
    "the motors fail": partial(Rig.motor, works=False),
    "the motors work": partial(Rig.motor, works=True),
    "the program ends": lambda rig: rig.shutdown(),
}  # fmt: skip
"""What stops the rover from inside."""

BATTERY: dict[str, Event] = {
    **DRIVER, **DISARM, **SHORT, **_mode("A", Mode.GUIDED),
    "A sends a setpoint": lambda rig: rig.setpoint("A"),
    **{f"battery {state}": partial(Rig.battery, state=state) for state in ("ok", "low", "critical")},
}  # fmt: skip
"""An empty battery, driven by hand and by setpoints."""

POSITION: dict[str, Event] = {
    **{name: DRIVER[name] for name in ("A arms", "A releases")}, **DISARM, **HOLD,
    **SILENCE, **_mode("A", Mode.AUTO),
    "A rests for 0.54 s": lambda rig: rig.wait(0.54, "A", NEUTRAL),
    "the position is lost": partial(Rig.position, known=False),
    "the position is known": partial(Rig.position, known=True),
}  # fmt: skip
"""A lost position and a lost ground station, in a mode that drives itself."""

ALL_STOPS: dict[str, Event] = {**STOPS, **FAULTS}
ALL_HAZARDS: dict[str, Event] = {
    **BATTERY, **POSITION, **_mode("B", Mode.AUTO), "A drives for 2.52 s": lambda rig: rig.wait(2.52, "A", AHEAD),
}  # fmt: skip
