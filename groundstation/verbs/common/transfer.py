"""Downloads into a file, which an interrupted download leaves as FILE.part and the next one resumes."""

from __future__ import annotations

import asyncio
import contextlib
from collections.abc import Awaitable, Callable

from groundstation.vehicles.requests.requests import RequestReport, RequestState
from groundstation.vehicles.requests.transfer_requests import KEEP_PERIOD
from groundstation.verbs.common.exit_codes import VerbError
from groundstation.verbs.common.files import Files

Fetch = Callable[[bytes], Awaitable[tuple[RequestReport, bytes]]]
"""Downloads behind the beginning that is there already; returns the report and what arrived from the start."""


class PartialDownload:
    """What has arrived of a download, also when it is interrupted. `beginning_of` takes the number of the request."""

    def __init__(self, beginning_of: Callable[[int], bytes]) -> None:
        self._beginning_of = beginning_of
        self._number: int | None = None
        self._left = b""

    def begin(self, number: int) -> None:
        """Take the number of the request that downloads."""
        self._number, self._left = number, b""

    def interrupt(self, number: int) -> None:
        """Keep what has arrived: the request is about to be cancelled."""
        self._left = self._beginning_of(number)

    @property
    def beginning(self) -> bytes:
        """What has arrived without a gap from the start."""
        return self._left or (b"" if self._number is None else self._beginning_of(self._number))


async def download_to(
    files: Files, file: str, fetch: Fetch, arrived: PartialDownload, *, overwrite: bool, resumable: bool = True
) -> RequestReport:
    """Download into `file`. What has arrived is kept every few seconds, and when the verb is interrupted."""
    await files.check_new(file, overwrite=overwrite)
    if not resumable:
        report, data = await fetch(b"")
        if report.state is RequestState.ACCEPTED:
            await files.store(file, data)
        return report
    have = await files.read_part(file)
    keeping = asyncio.ensure_future(_keep_regularly(files, file, arrived, len(have)))
    kept, ended = have, False
    try:
        report, data = await fetch(have)
        if report.state is RequestState.REFUSED and have:
            report, data = await fetch(b"")  # what was kept is of another file, or of an older state of it
        ended, kept = True, data
    finally:
        keeping.cancel()
        await asyncio.wait({keeping})
        if not ended:
            kept = max(have, arrived.beginning, key=len)
            await files.keep_part(file, kept)
    if report.state is RequestState.ACCEPTED:
        await files.store(file, kept)
    else:
        await files.keep_part(file, kept)
    return report


async def _keep_regularly(files: Files, file: str, arrived: PartialDownload, size: int) -> None:
    """Keep what has arrived if it is more than `size` bytes, again and again."""
    while True:
        await asyncio.sleep(KEEP_PERIOD)
        data = arrived.beginning
        if len(data) > size:
            size = len(data)
            with contextlib.suppress(VerbError):  # the end of the download tells
                await files.keep_part(file, data)
