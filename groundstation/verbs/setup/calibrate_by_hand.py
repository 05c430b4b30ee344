"""`mavhelm calibrate compass` and `sticks`: what needs hands on the vehicle or its transmitter."""

from __future__ import annotations

import argparse
import asyncio
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from dialects import messages as m
from dialects.enums import Command
from groundstation.vehicles.calibration.calibration import KINDS, MAG_CAL_RATE, REQUEST, WRITE, kind_for
from groundstation.vehicles.calibration.compass_calibration import CompassCalibration
from groundstation.vehicles.calibration.stick_calibration import RATE, StickCalibration
from groundstation.vehicles.requests.requests import RequestReport, RequestState
from groundstation.verbs.common.exit_codes import ExitCode, VerbError
from groundstation.verbs.common.output import Output
from groundstation.verbs.session.reports import finish
from groundstation.verbs.session.session import VerbSession
from link.core import Received

SILENCE = 10.0
"""s without a report of the compass after which the calibration counts as not answered."""
STICKS_FOR = 20.0
"""s for the sticks, unless --for says otherwise."""
REQUEST_PERIOD = 0.3
"""s between two requests for the RC channels until they come."""
PERIOD = 0.2
"""s between two looks at what was reported."""


async def compass(session: VerbSession, options: argparse.Namespace, output: Output) -> int:
    """Calibrate all compasses and write their results; cancelled when this program is interrupted."""
    name = session.vehicle.name
    kind = kind_for("compass", session.vehicle.autopilot)
    if kind != "compass":
        raise VerbError(ExitCode.REFUSED, f"{name} reports no progress of a compass: use the Setup screen")
    calibration = CompassCalibration()
    with _listening(session, calibration.receive):
        for message in (m.MagCalProgress, m.MagCalReport):
            _request(session, message.id, MAG_CAL_RATE)
        report = None
        try:
            report = await _command(session, KINDS[kind].command, KINDS[kind].params, f"{REQUEST}compass")
            if report.state is RequestState.ACCEPTED:
                output.note(f"{name}: turn it slowly about every axis, outdoors; Ctrl-C cancels")
                await _measured(session, calibration, output)
        finally:
            # Also when interrupted before the answer has come: the vehicle may have begun.
            if not calibration.ready and (report is None or report.state is RequestState.ACCEPTED):
                _send(session, Command.DO_CANCEL_MAG_CAL)
    if report.state is not RequestState.ACCEPTED:
        return finish(session, report, output)
    if not calibration.ready:
        raise VerbError(ExitCode.REFUSED, f"{name}: {calibration.summary}")
    report = await _command(session, Command.DO_ACCEPT_MAG_CAL, (0.0,), f"{REQUEST}{WRITE}")
    fits = [round(fit, 1) for _, fit in sorted(calibration.fits.items())]
    return finish(session, report, output, f"{calibration.summary}: written; restart it", kind="compass", fits=fits)


async def _measured(session: VerbSession, calibration: CompassCalibration, output: Output) -> None:
    """Wait until every compass has reported. Raises VerbError when nothing is reported any more."""
    shown, since = "", session.now
    while not (calibration.summary and calibration.ended):
        await asyncio.sleep(PERIOD)
        if calibration.summary != shown:
            shown, since = calibration.summary, session.now
            share = round(100 * (calibration.share or 0.0))
            output.progress(RequestReport(0, shown, done=share, total=100))
        elif session.now - since > SILENCE and not calibration.progress:
            raise VerbError(ExitCode.NO_ANSWER, f"{session.vehicle.name}: no progress of a compass for {SILENCE:g} s")


async def sticks(session: VerbSession, options: argparse.Namespace, output: Output) -> int:
    """Watch the RC channels and print what `param load` takes; writes nothing."""
    name, seconds = session.vehicle.name, options.seconds or STICKS_FOR
    if session.vehicle.armed:
        raise VerbError(ExitCode.REFUSED, f"{name} is armed: disarm it before the sticks are calibrated")
    calibration = StickCalibration()
    calibration.begin()
    with _listening(session, calibration.receive):
        output.note(f"{name}: move all sticks to their ends, then centre them; {seconds:g} s")
        await _watch_channels(session, calibration, seconds)
        _request(session, m.RcChannels.id, 0.0)
    if not calibration.rows:
        raise VerbError(ExitCode.NO_ANSWER, f"{name}: no RC channel was reported")
    if not calibration.moved:
        raise VerbError(ExitCode.DIFFERS, f"{name}: no stick was moved from end to end")
    for row in calibration.rows:
        if row.moved:
            output.record(channel=row.channel, min=row.low, trim=row.now, max=row.high)
    for parameter, value in calibration.values.items():
        output.line(f"{parameter:<16} {value:.0f}")
    output.note("nothing is written yet: `param load FILE` takes these lines")
    return ExitCode.DONE


async def _watch_channels(session: VerbSession, calibration: StickCalibration, seconds: float) -> None:
    """Let the RC channels come for so long; a request for them may get lost."""
    until = session.now + seconds
    while (left := until - session.now) > 0:
        if not calibration.rows:
            _request(session, m.RcChannels.id, RATE)
        await asyncio.sleep(min(REQUEST_PERIOD, left))


@contextmanager
def _listening(session: VerbSession, take: Callable[[m.Message], object]) -> Iterator[None]:
    """Pass on the messages of the vehicle."""

    def tap(received: Received, now: float) -> None:
        if received.system == session.vehicle.system:
            take(received.message)

    session.core.taps.append(tap)
    try:
        yield
    finally:
        session.core.taps.remove(tap)


async def _command(session: VerbSession, command: Command, params: tuple[float, ...], what: str) -> RequestReport:
    commands = session.services.commands
    return await session.request(lambda number, now: commands.send(number, command, params, what, now))


def _request(session: VerbSession, message: int, rate: float) -> None:
    """Request a message at a rate, once; 0: at the rate that it has without a request."""
    _send(session, Command.SET_MESSAGE_INTERVAL, float(message), round(1e6 / rate) if rate else 0.0)


def _send(session: VerbSession, command: Command, first: float = 0.0, second: float = 0.0) -> None:
    """Send a command once: nothing waits for its acknowledgement."""
    target = session.services.commands.target
    session.core.send(m.CommandLong(*target, command, 0, first, second, 0, 0, 0, 0, 0))
    session.flush()
