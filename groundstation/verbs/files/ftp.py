"""`mavhelm ftp`: list, get, put, remove and compare files on a vehicle, by MAVLink FTP."""

from __future__ import annotations

import argparse
from collections.abc import Callable
from pathlib import PurePosixPath

from groundstation.natural_order import natural_key
from groundstation.vehicles.requests.disk_jobs import name_problem
from groundstation.vehicles.requests.requests import RequestReport, RequestState
from groundstation.verbs.common.exit_codes import ExitCode, VerbError, code_of
from groundstation.verbs.common.output import Output
from groundstation.verbs.common.transfer import PartialDownload, download_to
from groundstation.verbs.session.reports import finish
from groundstation.verbs.session.session import VerbSession
from link.services.ftp.job import FtpOutcome
from link.services.ftp.protocol import crc32


async def ls(session: VerbSession, options: argparse.Namespace, output: Output) -> int:
    """List a folder."""
    files = session.services.files
    report, outcome = await _ask(session, lambda number, now: files.list_folder(number, options.path, now))
    if outcome is not None and outcome.done:
        for entry in sorted(outcome.entries, key=lambda entry: (entry.size is not None, natural_key(entry.name))):
            size = "" if entry.size is None else str(entry.size)
            output.line(f"{size:>10}  {entry.name}{'/' if entry.size is None else ''}")
            output.record(name=entry.name, size=entry.size, folder=entry.size is None)
    return _finish(session, report, output)


async def get(session: VerbSession, options: argparse.Namespace, output: Output) -> int:
    """Download a file; one that was interrupted is resumed, and the checksum compared."""
    files = session.services.files
    local = options.local or PurePosixPath(options.remote.partition("?")[0]).name
    if not local:
        raise VerbError(ExitCode.USAGE, f"{options.remote!r} names no file")
    if not options.local and (problem := name_problem(local)):
        raise VerbError(ExitCode.USAGE, f"{problem}: name the local file, too")

    arrived = PartialDownload(files.beginning_of)

    async def fetch(have: bytes) -> tuple[RequestReport, bytes]:
        return await download_file(session, options.remote, have, arrived)

    made = options.remote.startswith("@")  # the vehicle makes it anew each time: a beginning is of no use
    report = await download_to(session.files, local, fetch, arrived, overwrite=options.yes, resumable=not made)
    if report.state is RequestState.ACCEPTED:
        output.note(f"{options.remote} of {session.vehicle.name} saved to {local}")
    return _finish(session, report, output, file=local)


async def put(session: VerbSession, options: argparse.Namespace, output: Output) -> int:
    """Upload a file; an existing one is replaced."""
    data = await session.files.read_bytes(options.local)
    await session.need_only_vehicle(options.vehicle)
    files = session.services.files
    report, _ = await _ask(session, lambda number, now: files.upload(number, options.remote, data, now))
    return finish(session, report, output, f"has {options.local} as {options.remote}")


async def rm(session: VerbSession, options: argparse.Namespace, output: Output) -> int:
    """Remove a file."""
    await session.need_only_vehicle(options.vehicle)
    files = session.services.files
    report, _ = await _ask(session, lambda number, now: files.remove(number, options.remote, now))
    return finish(session, report, output)


async def crc(session: VerbSession, options: argparse.Namespace, output: Output) -> int:
    """Print the checksum of a file; with a local file, compare the two."""
    local = crc32(await session.files.read_bytes(options.local)) if options.local else None
    files = session.services.files
    report, outcome = await _ask(session, lambda number, now: files.checksum(number, options.remote, now))
    if outcome is None or outcome.checksum is None:
        return _finish(session, report, output)
    output.line(f"{outcome.checksum:08x}")
    same = None if local is None else local == outcome.checksum
    output.record(file=options.remote, crc32=f"{outcome.checksum:08x}", same=same)
    if local in (None, outcome.checksum):
        return ExitCode.DONE
    output.error(f"{options.local} has {local:08x}: the files differ")
    return ExitCode.DIFFERS


async def download_file(
    session: VerbSession, path: str, have: bytes, arrived: PartialDownload
) -> tuple[RequestReport, bytes]:
    """Download a file behind the beginning `have`; return how that ended, and what is there from the start."""
    files = session.services.files

    def start(number: int, now: float) -> None:
        arrived.begin(number)
        files.download(number, path, now, have)

    report = await session.request(start, arrived.interrupt)
    outcome = files.pop_result(report.number)
    return report, outcome.data if outcome is not None else b""


async def _ask(session: VerbSession, start: Callable[[int, float], None]) -> tuple[RequestReport, FtpOutcome | None]:
    """Make a request; return how it ended and what it brought."""
    report = await session.request(start)
    return report, session.services.files.pop_result(report.number)


def _finish(session: VerbSession, report: RequestReport, output: Output, **fields: object) -> int:
    """Print a failure, and the result with --json."""
    done = report.state is RequestState.ACCEPTED
    if not done:
        output.error(f"{session.vehicle.name}: {report.text}")
    if not done or fields:
        output.result(done, session.vehicle.system, detail=report.detail, text=report.reason, **fields)
    return code_of(report)
