"""OVERRIDES: what a line does in place of a verb's function: by an intent of the station, as a key of a screen."""

from __future__ import annotations

import argparse
from collections.abc import Awaitable, Callable

from dialects.mode_tables import HOLD
from groundstation.intents.driving import EmergencyStop, Stop
from groundstation.intents.vehicle import Disarm, ReleaseControl, RequestControl, SetMode
from groundstation.station.driving.handover import ANSWER_WITHIN
from groundstation.vehicles.demand.repeated_stop import StopEvidence
from groundstation.vehicles.demand.stop_commands import StopKind, shows_mode
from groundstation.vehicles.state.senders import ReportingSender, is_disarmed
from groundstation.verbs.collected_output import CollectedOutput
from groundstation.verbs.common.exit_codes import ExitCode, VerbError
from groundstation.verbs.line.session import LineSession

STOPPED_WITHIN = 5.0
"""s for the heartbeat to report a stop, which the station repeats; after that the line says what it reports."""


def _need_selected(session: LineSession) -> None:
    if not session.is_selected:
        raise VerbError(ExitCode.USAGE, f"{session.vehicle.name} is not selected: n selects the next vehicle")


async def _wait_stopped(session: LineSession, shows: Callable[[ReportingSender], bool]) -> tuple[bool, str]:
    """Wait until the last report of each sender of its id shows the stop; return whether it does, and else who not."""
    began, state = session.now, session.vehicle
    evidence = StopEvidence(state.senders, shows, began)

    def is_stopped() -> bool:
        return evidence.is_done(session.now, newer=state.heartbeat_at > began)

    done = await session.wait_for(is_stopped, STOPPED_WITHIN)
    return done, "" if done else evidence.find_doubt(session.now) or "it is not heard"


async def _wait_disarmed(session: LineSession) -> tuple[bool, str]:
    return await _wait_stopped(session, is_disarmed)


async def disarm(session: LineSession, options: argparse.Namespace, output: CollectedOutput) -> int:
    """Disarm."""
    session.stop(StopKind.DISARM, Stop(), Disarm())
    done, doubt = await _wait_disarmed(session)
    output.note(f"{session.vehicle.name} {'is disarmed' if done else f'is not known to be disarmed: {doubt}'}")
    return ExitCode.DONE if done else ExitCode.NO_ANSWER


async def stop(session: LineSession, options: argparse.Namespace, output: CollectedOutput) -> int:
    """Stop the sticks, and change to HOLD."""
    state = session.vehicle
    session.stop(StopKind.HOLD, Stop(), SetMode(mode=HOLD))
    done, doubt = await _wait_stopped(session, lambda sender: shows_mode(state, sender, HOLD))
    output.note(f"{state.name} {'holds' if done else f'is not known to hold: {doubt}'}")
    return ExitCode.DONE if done else ExitCode.NO_ANSWER


async def emergency_stop(session: LineSession, options: argparse.Namespace, output: CollectedOutput) -> int:
    """Stop the motors and lock them."""
    if options.clear:
        raise VerbError(ExitCode.USAGE, "estop --clear is the key t, held for 1 s on Drive, so that no text does it")
    if options.cut:
        raise VerbError(ExitCode.USAGE, "estop --cut is the key X, held for 2 s on Drive, so that no text does it")
    session.stop(StopKind.EMERGENCY, EmergencyStop())
    if session.vehicle.model.flies and session.vehicle.may_fall:
        output.note(f"{session.vehicle.name}: emergency stop; it lands")
        return ExitCode.DONE
    done, doubt = await _wait_disarmed(session)
    output.note(f"{session.vehicle.name}: emergency stop{'' if done else f'; {doubt}'}")
    return ExitCode.DONE if done else ExitCode.NO_ANSWER


async def show_control(session: LineSession, options: argparse.Namespace, output: CollectedOutput) -> int:
    """Say who is in control."""
    state, driver = session.vehicle, session.vehicle.driver
    who = "this ground station" if session.contact.in_control else f"GCS {driver}" if driver else "nobody"
    output.note(f"{state.name} does not tell" if driver is None else f"{state.name}: {who} is in control")
    return ExitCode.DONE


async def request_control(session: LineSession, options: argparse.Namespace, output: CollectedOutput) -> int:
    """Take control, or ask the driver for it."""
    _need_selected(session)
    if options.takeover:
        raise VerbError(ExitCode.USAGE, "--takeover is T of the Links screen (F7)")
    if session.contact.in_control:
        output.note(f"{session.vehicle.name} is controlled by this ground station already")
        return ExitCode.DONE
    session.do(RequestControl())
    if session.vehicle.driver is not None and not await session.wait_for(
        lambda: session.contact.in_control, ANSWER_WITHIN
    ):
        output.note(f"{session.vehicle.name}: control was not given")
        return ExitCode.NOT_IN_CONTROL
    output.note(f"{session.vehicle.name}: control requested")
    return ExitCode.DONE


async def release_control(session: LineSession, options: argparse.Namespace, output: CollectedOutput) -> int:
    """Release control."""
    _need_selected(session)
    session.do(ReleaseControl())
    await session.wait_for(lambda: not session.contact.in_control, STOPPED_WITHIN)
    output.note(f"{session.vehicle.name}: control released")
    return ExitCode.DONE


OVERRIDES: dict[str, Callable[[LineSession, argparse.Namespace, CollectedOutput], Awaitable[int]]] = {
    "disarm": disarm, "stop": stop, "estop": emergency_stop,
    "control show": show_control, "control request": request_control, "control release": release_control,
}  # fmt: skip
"""Verb, or verb and action -> its function here. A line that stops imports nothing for it."""
