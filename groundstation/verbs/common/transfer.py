"""Downloads into a file of this machine, which an interrupted download leaves as FILE.part and the next one resumes."""

from __future__ import annotations

from collections.abc import Awaitable, Callable

from groundstation.disk.local_file import keep_part, read_part, store
from groundstation.vehicles.requests.requests import RequestReport, RequestState
from groundstation.verbs.common.local_file import check_new_file, file_errors

Fetch = Callable[[bytes], Awaitable[tuple[RequestReport, bytes]]]
"""Downloads behind the beginning that is there already; returns the report and what arrived from the start."""


async def download_to(
    file: str, fetch: Fetch, beginning: Callable[[], bytes], *, overwrite: bool, resumable: bool = True
) -> RequestReport:
    """Download into `file`. `beginning` returns what has arrived so far, which is kept if the verb is interrupted."""
    check_new_file(file, overwrite=overwrite)
    with file_errors():
        have = read_part(file) if resumable else b""
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
            _keep(file, kept, resumable)
    if report.state is RequestState.ACCEPTED:
        with file_errors():
            store(file, kept)
    else:
        _keep(file, kept, resumable)
    return report


def _keep(file: str, data: bytes, resumable: bool) -> None:
    """Keep the beginning for the next download."""
    if resumable:
        with file_errors():
            keep_part(file, data)
