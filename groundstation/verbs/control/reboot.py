"""`mavhelm reboot`: restart a vehicle."""

from __future__ import annotations

import argparse

from dialects.enums import Command
from groundstation.verbs.common.output import Output
from groundstation.verbs.session.reports import finish
from groundstation.verbs.session.session import VerbSession

AUTOPILOT = 1.0
"""Parameter 1 of PREFLIGHT_REBOOT_SHUTDOWN: restart the autopilot, not its computer."""


async def run(session: VerbSession, options: argparse.Namespace, output: Output) -> int:
    """Restart the vehicle; done when it has accepted."""
    await session.need_only_vehicle(options.vehicle)
    commands = session.services.commands
    report = await session.request(
        lambda number, now: commands.send(number, Command.PREFLIGHT_REBOOT_SHUTDOWN, (AUTOPILOT,), "reboot", now)
    )
    return finish(session, report, output, "restarts")
