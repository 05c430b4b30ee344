"""How a request of a verb ended: printed, and as the exit code."""

from __future__ import annotations

from typing import Any

from groundstation.vehicles.requests import RequestReport, RequestState
from groundstation.verbs.exit_codes import ExitCode, code_of
from groundstation.verbs.output import Output
from groundstation.verbs.session import VerbSession


def finish(session: VerbSession, report: RequestReport, output: Output, done: str = "", **fields: Any) -> int:
    """Print how a request that changes something ended, `done` if it was done; return the exit code."""
    contact, name = session.contact, session.vehicle.name
    accepted = report.state is RequestState.ACCEPTED
    driver = contact.other_driver
    code = code_of(report, driver)
    if accepted and done:
        output.note(f"{name} {done}{f': {report.detail}' if report.detail else ''}")
    elif not accepted:
        output.error(f"{name}: {report.text}")
    if code is ExitCode.NOT_IN_CONTROL:
        output.error(f"GCS {driver} is in control of {name}; `groundstation control request` asks for it")
    output.result(accepted, contact.state.system, **fields, detail=report.detail, text=report.reason)
    return code
