"""`groundstation reboot`: restart a vehicle."""

from __future__ import annotations

import argparse

from dialects.enums import Command
from groundstation.vehicles.requests import RequestState
from groundstation.verbs.exit_codes import code_of
from groundstation.verbs.output import Output
from groundstation.verbs.session import VerbSession

AUTOPILOT = 1.0
"""Parameter 1 of PREFLIGHT_REBOOT_SHUTDOWN: restart the autopilot, not its computer."""


async def run(session: VerbSession, options: argparse.Namespace, output: Output) -> int:
    """Restart the vehicle; done when it has accepted."""
    await session.need_only_vehicle(options.vehicle)
    commands, name = session.services.commands, session.vehicle.name
    report = await session.request(
        lambda number, now: commands.send(number, Command.PREFLIGHT_REBOOT_SHUTDOWN, (AUTOPILOT,), "reboot", now)
    )
    done = report.state is RequestState.ACCEPTED
    if done:
        output.note(f"{name} restarts")
    else:
        output.error(f"{name}: {report.text}")
    output.result(done, session.vehicle.system, detail=report.detail, text=report.reason)
    return code_of(report)
