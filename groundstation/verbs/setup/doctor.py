"""`mavhelm doctor`: why the vehicle cannot be driven, and what to do."""

from __future__ import annotations

import argparse

from groundstation.doctor.report import format_chain, format_report
from groundstation.intents.setup import RunChecks
from groundstation.verbs.common.exit_codes import ExitCode
from groundstation.verbs.common.output import Output
from groundstation.verbs.session.doctor_session import DoctorSession
from groundstation.verbs.session.session import NUMBERS
from groundstation.views.doctor import DoctorView
from link.runtime.diagnosis import MARKS, Health
from link.runtime.wsl import wsl_hints

SETTLE = 3.5
"""s for the vehicle to answer: settings that it does not have are requested for 3 s, the checks for 2 s."""
AWAITED = ("link", "pre_arm", "stop_bound", "gcs_failsafe")
"""Rows that wait for answers of the vehicle."""


async def run(session: DoctorSession, options: argparse.Namespace, output: Output) -> int:
    """Print the chain; done when nothing stops the operator."""
    if options.report:
        await session.files.check_new(options.report, overwrite=options.yes)
    found = await session.find_vehicle(options.wait, options.vehicle)
    if found:
        await _ask(session)
    view = session.doctor
    for row in view.rows:
        output.record(row=row.id, health=row.health.value, evidence=row.evidence, advice=row.advice, set=_fix(row.fix))
    for line in format_chain(view):
        output.line(line)
    if options.report:
        log = (f"{line.label}: {line.text}" for line in session.snapshot.texts)
        await session.files.write_text(options.report, format_report(view, log=log))
        output.note(f"report saved to {options.report}")
    for hint in () if found else wsl_hints():
        output.note(hint)
    return _finish(view, output, None if found else session.describe_links())


async def _ask(session: DoctorSession) -> None:
    """Let the vehicle run its checks, and wait for what it tells."""
    await session.until(lambda: bool(session.doctor.system), SETTLE)
    view = session.doctor
    if not view.armed:
        session.do(RunChecks(next(NUMBERS), view.system))
    await session.until(lambda: _is_settled(session.doctor), SETTLE)


def _is_settled(view: DoctorView) -> bool:
    asked = view.armed or (view.checked is not None and view.checked.state != "running")
    return asked and not any(row.health is Health.UNKNOWN for row in view.rows if row.id in AWAITED)


def _fix(fix: object) -> object:
    """Return a proposed parameter change for JSON."""
    return None if fix is None else {"name": getattr(fix, "name", ""), "value": getattr(fix, "value", None)}


def _finish(view: DoctorView, output: Output, silence: str | None) -> int:
    """`silence`: why no vehicle was heard, None if one was."""
    stops = [row.title for row in view.faults]
    output.result(silence is None and not stops, view.system or None, faults=[row.id for row in view.faults])
    if silence is not None:
        output.error(f"no vehicle was heard{silence}")
        return ExitCode.NO_VEHICLE
    if stops:
        output.note(f"{view.name} cannot be driven: {', '.join(stops)} ({MARKS[Health.FAULT]} above)")
        return ExitCode.DIFFERS
    doubtful = [row.title for row in view.rows if row.health is Health.WARNING]
    if doubtful:
        marked = f"{', '.join(doubtful)} ({MARKS[Health.WARNING]} above)"
        output.note(f"no fault is known that stops you from driving {view.name}; look at {marked}")
    else:
        output.note(f"nothing stops you from driving {view.name}")
    return ExitCode.DONE
