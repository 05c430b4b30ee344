"""Driving by a verb: control and mode before it, what ends it, and the final neutrals and disarming after it."""

from __future__ import annotations

from dialects.axes import NEUTRAL, Axes
from dialects.enums import Autopilot
from dialects.kinds import MANUAL
from groundstation.vehicles.demand.demand_stream import DRIVING_PERIOD, FINAL_NEUTRALS
from groundstation.vehicles.demand.repeated_stop import StopTimes
from groundstation.vehicles.requests.requests import RequestReport, RequestState
from groundstation.verbs.common.exit_codes import ExitCode, VerbError, code_of
from groundstation.verbs.control.control import ask_for_control
from groundstation.verbs.control.stop_jobs import disarm_job
from groundstation.verbs.control.stops import run_job
from groundstation.verbs.session.reports import need_driven
from groundstation.verbs.session.session import VerbSession
from link.core import Received

DISARM_WITHIN = 10.0
"""s for which the disarming at the end is repeated."""
SETTINGS_WITHIN = 6.0
"""s in which the settings are read that say what it does without a link: two rounds of requests."""
SETTINGS_PERIOD = 0.1
"""s between looks whether a question for them is due."""
FRAME_PARAMETER = "CA_AIRFRAME"
"""What decides on the axes of PX4."""


async def begin_driving(session: VerbSession, *, leave_hold: bool = True) -> None:
    """Take control, change HOLD to MANUAL unless told not to, and show neutral. Raises VerbError."""
    state = session.vehicle
    need_driven(session.vehicle)
    await need_safe_flight(session)
    if state.drives_itself:
        raise VerbError(ExitCode.REFUSED, f"{state.name} drives itself ({state.mode}); `mavhelm stop` stops it")
    if state.has_rover_dialect and not state.driver:
        need_accepted(await ask_for_control(session), session)
    if leave_hold and state.mode in state.model.standing:
        modes = session.services.modes
        need_accepted(await session.request(lambda number, now: modes.set(number, MANUAL, now)), session)
    await learn_frame(session)
    await session.demand_neutral()
    need_control(session)


async def need_safe_flight(session: VerbSession) -> None:
    """Raise VerbError for what flies, is not in the air, and would fall or fly on without a link."""
    state, fleet_contact = session.vehicle, session.contact.contact
    if not state.model.flies or state.in_air:
        return
    await _read_settings(session)
    if why := fleet_contact.take_off_refusal:
        raise VerbError(ExitCode.REFUSED, f"{state.name}: no take-off: {why}")
    check = fleet_contact.settings_check
    if check is not None and check.obeys:
        raise VerbError(ExitCode.REFUSED, f"{state.name}: {check.obeys}")


async def _read_settings(session: VerbSession) -> None:
    """Read the settings that say what it does without a link; a station that this verb goes through does so itself."""
    core, contact = session.core, session.contact.contact
    until = session.now + SETTINGS_WITHIN

    def receive(received: Received, now: float) -> None:
        if received.system == contact.state.system and contact.settings_check is not None:
            contact.settings_check.receive(received, now)

    if not core.has_heard_all:
        core.taps.append(receive)
    while contact.take_off_refusal and session.now < until:
        if contact.settings_check is not None and not core.has_heard_all:
            core.outbox.commands += contact.settings_check.tick(session.now)
            session.flush()
        await session.wait_for(lambda: not contact.take_off_refusal, SETTINGS_PERIOD)
    if receive in core.taps:
        core.taps.remove(receive)


async def learn_frame(session: VerbSession) -> None:
    """Find out which axes turn the nose of PX4: in reverse they differ by how the vehicle steers."""
    check, params = session.contact.contact.settings_check, session.services.params
    if session.vehicle.autopilot == Autopilot.PX4 and check is not None and check.frame is None:
        await session.request(lambda number, now: params.read(number, FRAME_PARAMETER, now))


def need_control(session: VerbSession) -> None:
    """Raise VerbError if another program is in control, or this one may not drive."""
    contact = session.contact
    if contact.unproven:
        raise VerbError(ExitCode.REFUSED, f"{contact.state.name}: {contact.unproven}")
    if contact.other_driver is not None and not contact.state.control.silent:
        text = f"GCS {contact.other_driver} is in control of {contact.state.name}"
        raise VerbError(ExitCode.NOT_IN_CONTROL, f"{text}; `mavhelm control request` asks for it")


def drive_fault(session: VerbSession) -> str | None:
    """Return why the vehicle takes no demands now, or None."""
    state = session.vehicle
    if state.model.refusal:
        return f"is not driven: {state.model.refusal}"
    if state.emergency_stop:
        return "is in the emergency stop"
    if not state.armed:
        return "is disarmed"
    return None if state.mode in state.model.keys else f"takes no demands in {state.mode}"


def check_driving(session: VerbSession, axes: Axes, began: float) -> None:
    """Raise VerbError if this program stood still, or if a demand is not neutral and the vehicle does not take it.

    `began`: when it began to drive, for the text.
    """
    state, now = session.vehicle, session.now
    stood = session.core.standstill.last(now)
    if stood is not None:
        raise VerbError(ExitCode.BROKEN, f"this program stood still for {stood:.1f} s: the demand has ended")
    if axes.neutral:
        return
    after = f"after {now - began:.1f} s"
    if not state.monitor.is_alive(now):
        raise VerbError(ExitCode.NO_ANSWER, f"{state.name}: link lost {after}; neutral")
    need_control(session)
    fault = drive_fault(session)
    if fault is not None:
        raise VerbError(ExitCode.REFUSED, f"{state.name} {fault} {after}; neutral")


def need_accepted(report: RequestReport, session: VerbSession) -> None:
    """Raise VerbError for a request that was not accepted."""
    if report.state is not RequestState.ACCEPTED:
        raise VerbError(code_of(report, session.contact.other_driver), f"{session.vehicle.name}: {report.text}")


async def disarm_vehicle(session: VerbSession) -> RequestReport:
    """Disarm, repeated until the heartbeat reports it."""
    state, times = session.vehicle, StopTimes(session.now, session.sure_at, session.now + DISARM_WITHIN)
    return await run_job(session, "disarm", lambda number, now: disarm_job(number, state, times))


async def leave(session: VerbSession, *, disarm: bool) -> RequestReport | None:
    """Send the final neutrals, then disarm; return how that ended. A program that goes on keeps a copter hovering."""
    operator = session.contact.operator
    operator.demand = lambda _: NEUTRAL
    if session.goes_on and session.vehicle.model.flies and session.vehicle.armed:
        return None  # it hovers by neutral demands until the program ends; without them its own failsafe acts
    operator.demanding = False
    await session.wait_for(lambda: operator.finished, 2 * FINAL_NEUTRALS * DRIVING_PERIOD)
    return await disarm_vehicle(session) if disarm and session.vehicle.armed else None
