"""`mavhelm modes` and `mode`: the modes of a vehicle, and a change of mode."""

from __future__ import annotations

import argparse

from dialects.mode_tables import HOLD
from groundstation.vehicles.requests.mode_requests import VehicleMode
from groundstation.vehicles.requests.requests import RequestState
from groundstation.vehicles.state.vehicle_state import VehicleState
from groundstation.verbs.common.exit_codes import ExitCode, VerbError
from groundstation.verbs.common.output import Output
from groundstation.verbs.session.reports import finish
from groundstation.verbs.session.session import VerbSession


async def list_modes(session: VerbSession, options: argparse.Namespace, output: Output) -> int:
    """Print the modes, as the vehicle lists them, else by autopilot and type."""
    report = await session.request(session.services.modes.list_modes)
    modes = session.services.modes
    if not modes.modes:
        raise VerbError(ExitCode.DIFFERS, f"{session.vehicle.name} does not list its modes, and its type is not known")
    for mode in modes.modes:
        current = mode.custom_mode == modes.current
        mark, note = ">" if current else " ", "" if mode.selectable else "  not now"
        output.line(f"{mark} {mode.name:<12} {mode.custom_mode:>10}{note}")
        output.record(name=mode.name, custom_mode=mode.custom_mode, selectable=mode.selectable, current=current)
    if report.detail:
        output.note(f"{session.vehicle.name}: {report.detail}, by its autopilot and type")
    return ExitCode.DONE


def may_move(options: argparse.Namespace, state: VehicleState) -> bool:
    """Return whether the vehicle may move by itself in the mode of these arguments."""
    number = state.model.number_of(options.name)
    return number is None or state.model.moves_itself(state.model.mode_name(number))


async def set_mode(session: VerbSession, options: argparse.Namespace, output: Output) -> int:
    """Change the mode; done when the heartbeat reports it."""
    await session.need_only_vehicle(options.vehicle)
    modes, name = session.services.modes, options.name.upper()
    report = await session.request(lambda number, now: modes.set(number, name, now))
    mode = modes.find(name)
    name = name if mode is None else mode.name
    if mode is not None and report.state is RequestState.ACCEPTED:
        _tell_of_motion(session, mode, output)
    return finish(session, report, output, mode=name)


def _tell_of_motion(session: VerbSession, mode: VehicleMode, output: Output) -> None:
    """Say how the vehicle may move in its new mode without demands."""
    vehicle = session.vehicle
    if mode.moves_itself:
        output.note(f"{vehicle.name} may move by itself in {mode.name}{session.afterwards}")
    elif mode.name == HOLD and vehicle.model.hold_moves:
        output.note(f"{vehicle.name} holds its place, and may drive for it")
