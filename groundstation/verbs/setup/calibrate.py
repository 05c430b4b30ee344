"""`mavhelm calibrate`: gyros, level and pressure at rest; compass and sticks are in calibrate_by_hand.py."""

from __future__ import annotations

import argparse
import asyncio

from msgspec.structs import replace

from dialects.enums import Autopilot, SystemState
from groundstation.vehicles.calibration.calibration import KINDS, REQUEST, SHORT, kind_for
from groundstation.vehicles.calibration.reported_calibration import ReportedCalibration
from groundstation.vehicles.requests.requests import RequestReport, RequestState
from groundstation.verbs.common.exit_codes import ExitCode, VerbError
from groundstation.verbs.common.output import Output
from groundstation.verbs.session.reports import finish
from groundstation.verbs.session.session import RequestStart, VerbSession
from groundstation.verbs.setup import calibrate_by_hand

BY_HAND = {"compass": calibrate_by_hand.compass, "sticks": calibrate_by_hand.sticks}
CHOICES = (*sorted(SHORT), *BY_HAND)
PERIOD = 0.1
"""s between two looks at what was reported."""


def only_reads(options: argparse.Namespace) -> bool:
    """Return whether nothing of the vehicle is changed."""
    return bool(options.kind == "sticks")


def check(options: argparse.Namespace) -> None:
    """Check that --for is given for the sticks only. Raises VerbError."""
    if options.seconds is not None and options.kind != "sticks":
        raise VerbError(ExitCode.USAGE, "--for is for `calibrate sticks`")


async def run(session: VerbSession, options: argparse.Namespace, output: Output) -> int:
    """Calibrate; done when the vehicle has accepted, PX4 when it reports the end."""
    await session.need_only_vehicle(options.vehicle)
    if options.kind in BY_HAND:
        return await BY_HAND[options.kind](session, options, output)
    vehicle, commands = session.vehicle, session.services.commands
    name = kind_for(options.kind, vehicle.autopilot)
    if name is None:
        raise VerbError(ExitCode.REFUSED, f"{vehicle.name} cannot calibrate {options.kind}")
    kind = KINDS[name]
    reported = ReportedCalibration(session.now) if vehicle.autopilot == Autopilot.PX4 else None
    if reported is not None:
        session.contact.texts.listener = lambda at, label, text, severity: reported.handle_text(text)
    report = await _request(
        session,
        lambda number, now: commands.send(number, kind.command, kind.params, f"{REQUEST}{name}", now),
        reported,
    )
    if reported is not None and report.state is RequestState.ACCEPTED:
        await _wait_for_end(session, reported, output)
    return finish(session, report, output, f"has calibrated: {kind.title}", kind=options.kind)


async def _request(session: VerbSession, start: RequestStart, reported: ReportedCalibration | None) -> RequestReport:
    """Request a calibration.

    If the COMMAND_ACK of PX4 is lost, the repeated command meets the calibration that the first has begun: that
    refusal is an acceptance, unless another calibration was under way before.
    """
    was_under_way = session.vehicle.status == SystemState.CALIBRATING
    report = await session.request(start)
    if reported is None or was_under_way or report.state is not RequestState.REFUSED:
        return report
    has_begun = session.vehicle.status == SystemState.CALIBRATING or bool(reported.text)
    return replace(report, state=RequestState.ACCEPTED, detail="", reason="") if has_begun else report


async def _wait_for_end(session: VerbSession, reported: ReportedCalibration, output: Output) -> None:
    """Wait until PX4 reports the end. Raises VerbError if it has failed, or if no end is reported."""
    shown = ""
    while not reported.ended:
        reported.handle_status(session.vehicle.status, session.now)
        if reported.text != shown:
            shown = reported.text
            output.progress(RequestReport(0, shown))
        await asyncio.sleep(PERIOD)
    if reported.failure:
        code = ExitCode.NO_ANSWER if reported.silent else ExitCode.REFUSED
        raise VerbError(code, f"{session.vehicle.name}: {reported.failure}")
