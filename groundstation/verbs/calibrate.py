"""`groundstation calibrate`: gyros, level and pressure; what needs hands on the vehicle is on the Setup screen."""

from __future__ import annotations

import argparse

from groundstation.vehicles.calibration import KINDS, REQUEST, SHORT, kind_for
from groundstation.vehicles.requests import RequestState
from groundstation.verbs.exit_codes import ExitCode, VerbError, code_of
from groundstation.verbs.output import Output
from groundstation.verbs.session import VerbSession

CHOICES = tuple(sorted(SHORT))


async def run(session: VerbSession, options: argparse.Namespace, output: Output) -> int:
    """Calibrate; done when the vehicle has accepted."""
    await session.need_only_vehicle(options.vehicle)
    vehicle, commands = session.vehicle, session.services.commands
    name = kind_for(options.kind, vehicle.autopilot)
    if name is None:
        raise VerbError(ExitCode.REFUSED, f"{vehicle.name} cannot calibrate {options.kind}")
    kind = KINDS[name]
    report = await session.request(
        lambda number, now: commands.send(number, kind.command, kind.params, f"{REQUEST}{name}", now)
    )
    done = report.state is RequestState.ACCEPTED
    if done:
        output.note(f"{vehicle.name}: {kind.title} calibrated")
    else:
        output.error(f"{vehicle.name}: {report.text}")
    output.result(done, vehicle.system, kind=options.kind, detail=report.detail, text=report.reason)
    return code_of(report)
