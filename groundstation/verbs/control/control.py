"""`mavhelm control`: who is in control of a vehicle, and asking for it, releasing it, giving it."""

from __future__ import annotations

import argparse
from collections.abc import Callable

from dialects import messages as m
from dialects.enums import Command, Result
from groundstation.station.driving.handover import ANSWER_WITHIN, RELEASE, RELEASE_WITHIN, REQUEST
from groundstation.vehicles.requests.requests import RequestReport, RequestState
from groundstation.verbs.common.exit_codes import ExitCode, VerbError
from groundstation.verbs.common.output import Output
from groundstation.verbs.session.reports import finish
from groundstation.verbs.session.session import DRIVER_WITHIN, VerbSession
from link.core import Received


async def show(session: VerbSession, options: argparse.Namespace, output: Output) -> int:
    """Print who is in control."""
    await session.prove_session()
    # Also if it is known: another verb may just have changed it.
    await session.request_message(m.ControlStatus, DRIVER_WITHIN)
    control, takeover = session.vehicle.control, session.contact.details.takeover
    output.line(_describe(session))
    output.record(
        vehicle=session.vehicle.system, gcs_main=control.driver, component=control.component,
        session_id=control.session, silent=control.silent, clash=control.clash, takeover_allowed=takeover,
    )  # fmt: skip
    return ExitCode.DONE


async def request(session: VerbSession, options: argparse.Namespace, output: Output) -> int:
    """Take control, or ask the driver for it."""
    await session.need_only_vehicle(options.vehicle)
    report = await ask_for_control(session, takeover=options.takeover)
    free_now = session.vehicle.driver == 0 or session.contact.in_control
    if report.state is RequestState.REFUSED and free_now:  # the driver has released it meanwhile, or given it to us
        report = await ask_for_control(session, takeover=options.takeover)
    asked = session.contact.other_driver
    if report.state is RequestState.REFUSED and asked is not None:
        output.note(f"GCS {asked} is asked for control of {session.vehicle.name}")
        until = session.now + ANSWER_WITHIN
        while report.state is RequestState.REFUSED and session.now < until:
            if await session.wait_for(lambda: _is_free_or_ours(session), until - session.now):
                report = await ask_for_control(session, takeover=options.takeover)
    return _finish(session, report, output, "is controlled by this program; control ends some seconds after this verb")


async def release(session: VerbSession, options: argparse.Namespace, output: Output) -> int:
    """Release control; our own vehicle changes to HOLD."""
    await session.need_only_vehicle(options.vehicle)
    return _finish(session, await _release(session), output, "has no driver now")


async def give(session: VerbSession, options: argparse.Namespace, output: Output) -> int:
    """Give control to this ground station when it asks; done when the vehicle reports it as the driver."""
    await session.need_only_vehicle(options.vehicle)
    asked = _listen(session, options.system, options.station)
    report = await ask_for_control(session)
    if report.state is not RequestState.ACCEPTED:
        return _finish(session, report, output, "")
    output.note(f"waiting until GCS {options.station} asks for {session.vehicle.name}")
    if not await session.wait_for(asked, options.wait):
        await _release(session)
        raise VerbError(ExitCode.DIFFERS, f"GCS {options.station} did not ask within {options.wait:g} s")
    report = await _release(session, options.station if session.vehicle.has_rover_dialect else 0)
    if report.state is RequestState.ACCEPTED:
        station = options.station
        if not await session.wait_for(lambda: session.vehicle.driver == station, ANSWER_WITHIN):
            raise VerbError(ExitCode.DIFFERS, f"control was released, but GCS {station} has not taken it")
    return finish(session, report, output, f"is driven by GCS {options.station}")


UNMANAGED = Result.UNSUPPORTED
"""Answer of vehicles that take demands from any ground station: ArduPilot and PX4."""


def _finish(session: VerbSession, report: RequestReport, output: Output, done: str) -> int:
    if report.answer == UNMANAGED:
        text = "this vehicle does not manage control: it takes demands from any ground station"
        output.note(f"{session.vehicle.name}: {text}")
        output.result(True, session.vehicle.system, detail=report.detail, text=text)
        return ExitCode.DONE
    return finish(session, report, output, done)


async def ask_for_control(session: VerbSession, *, takeover: bool = False) -> RequestReport:
    """Request control; `takeover`: others may take it without asking."""
    return await _send(session, "request control", (REQUEST, float(takeover), ANSWER_WITHIN))


def _is_free_or_ours(session: VerbSession) -> bool:
    """Return whether the driver has released control, or given it to this program."""
    return not session.vehicle.driver or session.contact.in_control


async def _release(session: VerbSession, station: int = 0) -> RequestReport:
    report = await _send(session, "release control", (RELEASE, 0.0, 0.0, float(station)))
    if report.state is RequestState.ACCEPTED:
        await session.wait_for(lambda: not session.contact.in_control, RELEASE_WITHIN)
    return report


async def _send(session: VerbSession, what: str, params: tuple[float, ...]) -> RequestReport:
    commands = session.services.commands
    return await session.request(
        lambda number, now: commands.send(number, Command.REQUEST_OPERATOR_CONTROL, params, what, now)
    )


def _listen(session: VerbSession, ours: int, station: int) -> Callable[[], bool]:
    """Return whether this ground station has asked, as the vehicle forwards it, from now on."""
    heard: list[int] = []

    def tap(received: Received, now: float) -> None:
        message = received.message
        if not isinstance(message, m.CommandLong) or message.command != Command.REQUEST_OPERATOR_CONTROL:
            return
        if message.target_system == ours and message.param1 == REQUEST and message.param4 == station:
            heard.append(station)

    session.core.taps.append(tap)
    return lambda: bool(heard)


def _describe(session: VerbSession) -> str:
    control, name = session.vehicle.control, session.vehicle.name
    if control.driver is None:
        return f"{name} does not tell who is in control"
    if not control.driver:
        return f"{name}: nobody is in control"
    words = [f"{name}: GCS {control.driver}"]
    words += ["which is silent"] if control.silent else []
    words += ["two programs with its ids"] if control.clash else []
    words += ["others may take over"] if session.contact.details.takeover else []
    return ", ".join(words)
