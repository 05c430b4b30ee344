"""`groundstation log`: list and get the logs of a vehicle by LOG_REQUEST_LIST and LOG_DATA."""

from __future__ import annotations

import argparse
from datetime import UTC, datetime

from groundstation.vehicles.requests import RequestReport, RequestState
from groundstation.verbs.exit_codes import ExitCode, VerbError, code_of
from groundstation.verbs.output import Output
from groundstation.verbs.session import VerbSession
from groundstation.verbs.transfer import download_to
from link.services.log.client import RemoteLog

LATEST = "latest"


async def list_logs(session: VerbSession, options: argparse.Namespace, output: Output) -> int:
    """Print the logs on the vehicle."""
    logs = await _logs(session)
    for log in logs:
        output.line(f"{log.number:>5}  {_begun(log) or '--':<20} {log.size:>10}")
        output.record(id=log.number, time_utc=_begun(log), size=log.size)
    if not logs:
        output.note(f"{session.vehicle.name} has no logs")
    return ExitCode.DONE


async def get(session: VerbSession, options: argparse.Namespace, output: Output) -> int:
    """Download a log; one that was interrupted is resumed."""
    log = _choose(await _logs(session), options.log)
    requests = session.services.logs
    file = options.file or f"{session.vehicle.system}-{log.number:05}.bin"

    async def fetch(have: bytes) -> tuple[RequestReport, bytes]:
        report = await session.request(lambda number, now: requests.download(number, log, now, have))
        return report, requests.pop_data(report.number)

    report = await download_to(file, fetch, lambda: requests.beginning, overwrite=options.yes)
    done = report.state is RequestState.ACCEPTED
    if done:
        output.note(f"log {log.number} of {session.vehicle.name} saved to {file}")
    else:
        output.error(f"{session.vehicle.name}: {report.text}")
    output.result(done, session.vehicle.system, id=log.number, file=file)
    return code_of(report)


async def _logs(session: VerbSession) -> tuple[RemoteLog, ...]:
    report = await session.request(session.services.logs.list_logs)
    if report.state is not RequestState.ACCEPTED or session.services.logs.logs is None:
        raise VerbError(code_of(report), f"{session.vehicle.name}: {report.text}")
    return session.services.logs.logs


def _choose(logs: tuple[RemoteLog, ...], wanted: str) -> RemoteLog:
    """Return the log of this number, or the newest. Raises VerbError."""
    if wanted == LATEST and logs:
        return max(logs, key=lambda log: (log.begun, log.number))
    found = next((log for log in logs if str(log.number) == wanted), None)
    if found is None:
        there = ", ".join(str(log.number) for log in logs) or "none"
        raise VerbError(ExitCode.DIFFERS, f"there is no log {wanted}; there are: {there}")
    return found


def _begun(log: RemoteLog) -> str | None:
    """Return when a log was begun, ISO 8601."""
    return datetime.fromtimestamp(log.begun, UTC).strftime("%Y-%m-%dT%H:%M:%SZ") if log.begun else None
