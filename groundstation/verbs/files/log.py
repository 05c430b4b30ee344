"""`mavhelm log`: list the logs of a vehicle by LOG_REQUEST_LIST, get one, erase all.

Those of our own vehicle come by MAVLink FTP, which compares a checksum; those of others by LOG_DATA, which all have.
"""

from __future__ import annotations

import argparse
from datetime import UTC, datetime

from dialects.enums import Autopilot
from groundstation.vehicles.requests.requests import RequestReport, RequestState
from groundstation.vehicles.requests.transfer_requests import LOG_FOLDER, log_ending, log_path
from groundstation.verbs.common.exit_codes import ExitCode, VerbError, code_of
from groundstation.verbs.common.output import Output
from groundstation.verbs.common.transfer import PartialDownload, download_to
from groundstation.verbs.files.ftp import download_file
from groundstation.verbs.session.reports import finish
from groundstation.verbs.session.session import VerbSession
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
    requests, files = session.services.logs, session.services.files
    path = await _path(session, log)
    file = options.file or f"{session.vehicle.system}-{log.number:05}{log_ending(session.vehicle.autopilot)}"

    arrived = PartialDownload(requests.beginning_of if path is None else files.beginning_of)

    async def fetch(have: bytes) -> tuple[RequestReport, bytes]:
        if path is not None:
            return await download_file(session, path, have, arrived)

        def start(number: int, now: float) -> None:
            arrived.begin(number)
            requests.download(number, log, now, have)

        report = await session.request(start, arrived.interrupt)
        return report, requests.pop_data(report.number)

    report = await download_to(session.files, file, fetch, arrived, overwrite=options.yes)
    done = report.state is RequestState.ACCEPTED
    if done:
        output.note(f"log {log.number} of {session.vehicle.name} saved to {file}")
    else:
        output.error(f"{session.vehicle.name}: {report.text}")
    output.result(done, session.vehicle.system, id=log.number, file=file)
    return code_of(report)


async def erase(session: VerbSession, options: argparse.Namespace, output: Output) -> int:
    """Have the vehicle erase all its logs; its list shows afterwards whether it has."""
    if not options.yes:
        raise VerbError(ExitCode.USAGE, "this erases ALL logs of the vehicle; --yes does it")
    await session.need_only_vehicle(options.vehicle)
    return finish(session, await session.request(session.services.logs.erase), output, "has erased its logs")


async def _path(session: VerbSession, log: RemoteLog) -> str | None:
    """Return the path of a log of our own vehicle; None if it must come by LOG_DATA."""
    if session.vehicle.autopilot != Autopilot.GENERIC:
        return None
    files = session.services.files
    report = await session.request(lambda number, now: files.list_folder(number, LOG_FOLDER, now))
    return log_path(files.pop_result(report.number), log)


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
