"""The commands that stop a vehicle, in the form of its autopilot. The station and the verbs build every stop from here.

Sources: COMPONENT_ARM_DISARM and DO_SET_SAFETY_SWITCH_STATE of common.xml; ArduPilot GCS_MAVLink/GCS_Common.cpp; PX4
Commander.cpp (it knows no safety switch command, and its HOLD is AUTO with the sub mode LOITER).
"""

from __future__ import annotations

from enum import Enum

import msgspec

from dialects.enums import Command, ModeFlag
from dialects.kinds import AUTOPILOT_COMPONENT
from dialects.modes import set_mode_params
from groundstation.vehicles.state.senders import ReportingSender
from groundstation.vehicles.state.vehicle_state import VehicleState
from link.services.command.client import CommandClient

SAFE, DANGEROUS = 0, 1
"""SAFETY_SWITCH_STATE: motors off and locked; motors may run."""

FORCE_DISARM = 21196
"""Parameter 2 of COMPONENT_ARM_DISARM: disarm even while moving (common.xml)."""

PAUSE = 0
"""Parameter 1 of DO_PAUSE_CONTINUE."""

HOLD_OF_ANY = (4.0, 3.0)
"""Parameters 2 and 3 of DO_SET_MODE that stop a rover of unknown make: HOLD of ArduPilot and ours, which ignore the sub
mode, and AUTO/LOITER of PX4. Without the sub mode PX4 would start its mission."""


class StopKind(Enum):
    """A way to stop a vehicle."""

    DISARM = "disarm"
    HOLD = "stop"
    EMERGENCY = "emergency stop"
    CUT = "cut of the motors"
    """An emergency stop that cuts the motors of what flies, too, which then falls: only where that is asked for."""


STOP_VERBS = {"disarm": StopKind.DISARM, "stop": StopKind.HOLD, "estop": StopKind.EMERGENCY}
"""Verb -> its stop."""


class StopCommand(msgspec.Struct, frozen=True):
    """One command and its first parameters; further ones are 0."""

    command: Command
    params: tuple[float, ...]


DISARM = StopCommand(Command.COMPONENT_ARM_DISARM, (0.0,))
FORCED = StopCommand(Command.COMPONENT_ARM_DISARM, (0.0, float(FORCE_DISARM)))
LOCK = StopCommand(Command.DO_SET_SAFETY_SWITCH_STATE, (float(SAFE),))
PAUSED = StopCommand(Command.DO_PAUSE_CONTINUE, (float(PAUSE),))
LANDED = StopCommand(Command.NAV_LAND, ())
HELD = StopCommand(Command.DO_SET_MODE, (float(ModeFlag.CUSTOM), *HOLD_OF_ANY))

BLIND: dict[StopKind, tuple[StopCommand, ...]] = {
    StopKind.DISARM: (DISARM,),
    StopKind.HOLD: (PAUSED,),
    StopKind.EMERGENCY: (DISARM,),
    StopKind.CUT: (DISARM,),
}
"""Commands for vehicles that were not heard. None ends the flight of one in the air, and a mode is not among them: its
number is of the autopilot and its type. Every rover disarms by this; what flies refuses it in the air."""

BLIND_LATER: dict[StopKind, tuple[StopCommand, ...]] = {
    StopKind.HOLD: (HELD,),
    StopKind.EMERGENCY: (LANDED,),
    StopKind.CUT: (LOCK, FORCED),
}
"""Further ones once a heartbeat interval has passed in which no vehicle was heard. A copter in the air obeys the safety
switch and the forced disarm, and falls; so they are not sent to what may be one. It lands instead."""


def mode_command(state: VehicleState, name: str) -> StopCommand | None:
    """Return the change to a mode that stops or lands, by its name or an alias; None for a kind that has none."""
    number = state.model.number_of(name) if state.model.is_driven else None
    return None if number is None else StopCommand(Command.DO_SET_MODE, set_mode_params(number, state.autopilot))


def shows_mode(state: VehicleState, sender: ReportingSender, name: str) -> bool:
    """Return whether a sender of the vehicle's id shows this mode.

    A script on board that claims to be the autopilot has modes of its own; it must be disarmed.
    """
    if sender.component != state.component and not sender.armed:
        return True
    return sender.custom_mode == state.model.number_of(name)


def send_stop(client: CommandClient, state: VehicleState, stop: StopCommand, now: float, *, attempt: int = 0) -> None:
    """Send a stop to every component of a vehicle that claims to be its autopilot.

    To component 0 as well, which means all, if that is not the usual one alone; the client adds it to repeats. Every
    other `attempt` begins as COMMAND_INT: of two vehicles with one id one may accept, and the other take that only.
    """
    others = tuple(each for each in state.senders.components if each != state.component)
    further = () if not others and state.component == AUTOPILOT_COMPONENT else (0, *others)
    client.send(
        stop.command,
        *stop.params,
        target_system=state.system,
        target_component=state.component,
        now=now,
        further=further,
        stop=True,
        other_form=attempt % 2 == 1,
    )
