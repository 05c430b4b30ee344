"""`mavhelm arm`: the arming of the station (station/driving/arming.py), confirmed by the heartbeat.

What the vehicle takes to be armed is a live session: neutral demands and proofs go out while the verb runs. When it
ends nobody drives, and the failsafes of the vehicle act. A verb that is interrupted before the vehicle has confirmed
disarms it, because the vehicle may still act on the command.
"""

from __future__ import annotations

import argparse
import asyncio
from collections.abc import Callable

import msgspec

from dialects import messages as m
from dialects.enums import Command, Result
from groundstation.station.driving.arming import ArmSequence, ArmStep, find_arming_doubt
from groundstation.vehicles.demand.demand_stream import DRIVING_PERIOD, FINAL_NEUTRALS
from groundstation.vehicles.requests.requests import RequestBook, RequestReport, RequestState
from groundstation.verbs.common.exit_codes import ExitCode, VerbError
from groundstation.verbs.common.output import Output
from groundstation.verbs.control.driving import need_safe_flight
from groundstation.verbs.control.stop_jobs import refusal_words
from groundstation.verbs.control.stops import run_job
from groundstation.verbs.session.reports import finish, need_driven
from groundstation.verbs.session.session import VerbSession
from link.services.command.client import CommandClient, CommandOutcome

ASK_PERIOD = 1.0
"""s between two questions whether the pre-arm checks are passed."""
ANSWER_WITHIN = 0.3
"""s for SYS_STATUS behind the acknowledgement of its request; a vehicle without pre-arm checks never reports them."""


class ArmJob(msgspec.Struct):
    """The sequence as a request."""

    number: int
    sequence: ArmSequence
    claim: Callable[[float], None]
    """Called with the time when the vehicle has accepted, which is control of one that does not report it."""

    def tick(self, client: CommandClient, book: RequestBook, now: float) -> None:
        """Take the next step; the last one is that the heartbeat reports armed."""
        self.sequence.tick(client, now)
        if self.sequence.step is not ArmStep.DONE:
            return
        if self.sequence.failure is not None:
            book.refuse(self.number, self.sequence.failure, now, by_vehicle=False)
            self.sequence.failure = None
        elif self.sequence.vehicle.armed:
            book.accept(self.number)

    def handle_outcome(self, outcome: CommandOutcome, client: CommandClient, book: RequestBook, now: float) -> None:
        """End with the first refusal."""
        before = self.sequence.step
        self.sequence.handle_outcome(outcome, client, now)
        if before is ArmStep.ARM and self.sequence.step is ArmStep.CONFIRM:
            self.claim(now)
        if before is ArmStep.DONE or self.sequence.step is not ArmStep.DONE:
            return
        of_mode = outcome.command == Command.DO_SET_MODE
        mode = "MANUAL: " if of_mode else ""
        if outcome.number is None:
            book.fail(self.number, f"{mode}after all tries")
        elif outcome.result is not Result.ACCEPTED:
            answer = None if of_mode else outcome.number
            book.refuse(self.number, f"{mode}{refusal_words(outcome)}", now, answer=answer)


async def run(session: VerbSession, options: argparse.Namespace, output: Output) -> int:
    """Arm; done when the heartbeat reports it."""
    await session.need_only_vehicle(options.vehicle)
    state = session.vehicle
    if state.armed and not state.emergency_stop:
        await session.hear_all()
        if doubt := find_arming_doubt(state, session.now):
            raise VerbError(ExitCode.REFUSED, f"{state.name} reports ARMED, but {doubt}: two vehicles may have its id")
        output.note(f"{state.name} is armed already")
        output.result(True, state.system, armed=True, detail="armed already")
        return ExitCode.DONE
    report = await arm(session, options.wait, output)
    if report.state is RequestState.ACCEPTED:
        output.note(
            f"{state.name} is armed; nobody drives it when this verb ends, and its failsafe for that may stop it, "
            "disarm it or, in a mode that drives by itself, do what its settings say"
        )
    return finish(session, report, output, armed=state.armed)


async def arm(session: VerbSession, wait: float, output: Output, *, flown: bool = False) -> RequestReport:
    """Arm a vehicle that is disarmed, once it is ready, `wait` s after the start at most. Raises VerbError.

    `flown`: the verb flies a copter next, which without demands would disarm itself.
    """
    contact, state = session.contact, session.vehicle
    need_driven(session.vehicle)
    if state.emergency_stop:
        raise VerbError(ExitCode.REFUSED, f"{state.name}: emergency stop; `mavhelm estop --clear` releases it first")
    await need_safe_flight(session)
    await _wait_until_ready(session, wait, output)
    contact.operator.demanding = contact.other_driver is None
    try:
        report = await _arm_when_possible(session, session.began + wait)
    except asyncio.CancelledError:
        command = Command.COMPONENT_ARM_DISARM
        contact.client.send(command, 0, target_system=state.system, target_component=state.component, now=session.now)
        session.flush()
        raise
    finally:
        keeps = (session.goes_on or flown) and state.model.flies and state.armed
        contact.operator.demanding = keeps
    if not (session.goes_on or keeps):
        await session.wait_for(lambda: contact.operator.finished, 2 * FINAL_NEUTRALS * DRIVING_PERIOD)
    return report


async def arm_first(
    session: VerbSession, options: argparse.Namespace, output: Output, remedy: str
) -> RequestReport | None:
    """Arm a vehicle that is disarmed for a verb that drives it next, if its --arm says so.

    Returns the report of an arming that failed, else None. Raises VerbError, with the `remedy`, without --arm.
    """
    if not options.arm:
        raise VerbError(ExitCode.REFUSED, f"{session.vehicle.name} is disarmed: {remedy}")
    report = await arm(session, options.wait, output, flown=True)
    return None if report.state is RequestState.ACCEPTED else report


async def _arm_when_possible(session: VerbSession, until: float) -> RequestReport:
    """Arm; again while a vehicle refuses for the moment.

    PX4 does so until it has heard MANUAL_CONTROL for a while, which begins with this verb.
    """
    contact = session.contact
    while True:
        report = await run_job(
            session, "arm", lambda number, now: ArmJob(number, ArmSequence.start(contact.state, now), contact.claim)
        )
        if report.answer != Result.TEMPORARILY_REJECTED or session.now + ASK_PERIOD > until:
            return report
        await session.wait_for(lambda: False, ASK_PERIOD)


async def _wait_until_ready(session: VerbSession, wait: float, output: Output) -> None:
    """Wait until the pre-arm checks are passed, `wait` s after the start at most; then arming is refused with why."""
    commands = session.services.commands
    until = session.began + wait
    told = False
    while True:
        await session.request(
            lambda number, now: commands.send(
                number, Command.REQUEST_MESSAGE, (float(m.SysStatus.id),), "SYS_STATUS", now
            )
        )
        # The message may follow the acknowledgement of its request.
        await session.wait_for(lambda: session.vehicle.build_view(session.now).prearm is not None, ANSWER_WITHIN)
        view = session.vehicle.build_view(session.now)
        if view.prearm is not False or session.now >= until:
            return
        if not told:
            output.note(f"{session.vehicle.name} is not ready to arm: {view.prearm_reason or 'waiting'}")
            told = True
        left = until - session.now
        await session.wait_for(lambda: session.vehicle.ready_at is not None, max(0.0, min(ASK_PERIOD, left)))
