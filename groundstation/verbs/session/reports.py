"""How a request of a verb ended: reported by a heartbeat, printed, and as the exit code."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from groundstation.station.driving.arming import CONFIRM_WITHIN
from groundstation.vehicles.requests.requests import RequestReport, RequestState
from groundstation.vehicles.state.vehicle_state import VehicleState
from groundstation.verbs.common.exit_codes import ExitCode, VerbError, code_of
from groundstation.verbs.common.output import Output
from groundstation.verbs.session.session import VerbSession

SILENT_WITHIN = 5.0
"""s for a heartbeat to arrive after what was accepted, if none came in CONFIRM_WITHIN."""


def finish(session: VerbSession, report: RequestReport, output: Output, done: str = "", **fields: Any) -> int:
    """Print how a request that changes something ended, `done` if it was done; return the exit code."""
    contact, name = session.contact, session.vehicle.name
    accepted = report.state is RequestState.ACCEPTED
    driver = contact.other_driver
    code = code_of(report, driver)
    if accepted and done:
        output.note(f"{name} {done}{f': {report.detail}' if report.detail else ''}")
    elif not accepted:
        why = session.explain_silence() if report.state is RequestState.NO_ANSWER else ""
        output.error(f"{name}: {report.text}{why}")
    if code is ExitCode.NOT_IN_CONTROL:
        output.error(f"GCS {driver} is in control of {name}; `mavhelm control request` asks for it")
    output.result(accepted, contact.state.system, **fields, detail=report.detail, text=report.reason)
    return code


async def wait_for_report(session: VerbSession, condition: Callable[[], bool]) -> bool:
    """Wait for a heartbeat to report what was accepted; return whether one does within CONFIRM_WITHIN.

    A link that loses many frames may lose all heartbeats of that time: then the next one decides. Raises VerbError if
    none comes within SILENT_WITHIN more.
    """
    state, began = session.vehicle, session.now
    if await session.wait_for(condition, CONFIRM_WITHIN) or state.heartbeat_at >= began:
        return condition()
    if not await session.wait_for(lambda: state.heartbeat_at >= began, SILENT_WITHIN):
        silence = f"{CONFIRM_WITHIN + SILENT_WITHIN:g} s"
        raise VerbError(ExitCode.NO_ANSWER, f"{state.name}: accepted, but no heartbeat came for {silence}")
    return condition()


def need_driven(state: VehicleState) -> None:
    """Raise VerbError for a vehicle of a kind that is only shown (dialects/kinds.py)."""
    if state.model.refusal:
        raise VerbError(ExitCode.REFUSED, f"{state.name}: {state.model.refusal}")
