"""`groundstation modes` and `mode`: the modes of a vehicle, and a change of mode."""

from __future__ import annotations

import argparse

from groundstation.vehicles.requests import RequestState
from groundstation.verbs.exit_codes import ExitCode, VerbError
from groundstation.verbs.output import Output
from groundstation.verbs.reports import finish
from groundstation.verbs.session import VerbSession


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


async def set_mode(session: VerbSession, options: argparse.Namespace, output: Output) -> int:
    """Change the mode; done when the heartbeat reports it."""
    await session.need_only_vehicle(options.vehicle)
    modes, name = session.services.modes, options.name.upper()
    report = await session.request(lambda number, now: modes.set(number, name, now))
    moves = any(mode.name.upper() == name and mode.moves_itself for mode in modes.modes)
    if moves and report.state is RequestState.ACCEPTED:
        output.note(f"{session.vehicle.name} may move by itself in {name}; this program no longer sends heartbeats")
    return finish(session, report, output, mode=name)
