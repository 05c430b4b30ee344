"""Downloads into a file of this machine, which an interrupted download leaves as FILE.part and the next one resumes."""

from __future__ import annotations

from collections.abc import Awaitable, Callable
from pathlib import Path

from groundstation.vehicles.requests import RequestReport, RequestState
from groundstation.verbs.exit_codes import ExitCode, VerbError
from groundstation.verbs.local_file import check_new_file, write_bytes
from link.services.ftp.job import MAX_SIZE

Fetch = Callable[[bytes], Awaitable[tuple[RequestReport, bytes]]]
"""Downloads behind the beginning that is there already; returns the report and what arrived from the start."""


async def download_to(
    file: str, fetch: Fetch, beginning: Callable[[], bytes], *, overwrite: bool, resumable: bool = True
) -> RequestReport:
    """Download into `file`. `beginning` returns what has arrived so far, which is kept if the verb is interrupted."""
    check_new_file(file, overwrite=overwrite)
    part = Path(f"{file}.part")
    have = _read_part(part) if resumable else b""
    kept = have
    ended = False
    try:
        report, data = await fetch(have)
        if report.state is RequestState.REFUSED and have:
            report, data = await fetch(b"")  # what was kept is of another file, or of an older state of it
        ended, kept = True, data
    finally:
        if not ended:
            kept = max(have, beginning(), key=len)
            _keep(part, kept, resumable)
    if report.state is RequestState.ACCEPTED:
        _store(file, part, kept)
    else:
        _keep(part, kept, resumable)
    return report


def _store(file: str, part: Path, data: bytes) -> None:
    write_bytes(file, data)
    part.unlink(missing_ok=True)


def _read_part(part: Path) -> bytes:
    try:
        with part.open("rb") as opened:
            return opened.read(MAX_SIZE)
    except FileNotFoundError:
        return b""
    except OSError as error:
        raise VerbError(ExitCode.USAGE, f"{part}: {error.strerror}") from error


def _keep(part: Path, data: bytes, resumable: bool) -> None:
    """Keep the beginning for the next download."""
    if data and resumable:
        write_bytes(str(part), data)
