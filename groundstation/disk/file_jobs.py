"""FileJobs: runs the core's disk jobs in a thread, because a card may take a second to write."""

from __future__ import annotations

import asyncio
import contextlib
from collections.abc import Callable
from functools import partial

from groundstation.disk.local_file import (
    LocalFileError,
    check_new_file,
    checksum_of,
    keep_part,
    read_bytes,
    read_part,
    store,
)
from groundstation.station.station import Station
from groundstation.vehicles.requests.disk_jobs import DiskJob, DiskResult, DiskWork
from link.runtime.worker import Worker

CLOSE_WITHIN = 1.0
"""s for what is left to be written when the station ends."""


def run_job(job: DiskJob) -> DiskResult:
    """Run one job; what goes wrong is the result's `problem`."""
    data = b""
    try:
        if job.work is DiskWork.PREPARE:
            check_new_file(job.path, overwrite=job.overwrite)
            data = read_part(job.path)
        elif job.work is DiskWork.READ:
            data = read_bytes(job.path)
        elif job.work is DiskWork.CHECKSUM:
            return DiskResult(job.number, job.work, checksum=checksum_of(job.path))
        elif job.work is DiskWork.KEEP:
            keep_part(job.path, job.data)
        else:
            store(job.path, job.data)
    except (LocalFileError, ValueError) as error:  # ValueError: a path with a null character
        return DiskResult(job.number, job.work, problem=str(error))
    return DiskResult(job.number, job.work, data)


class FileJobs:
    """Runs the jobs of a station in their order. `flush` sends what follows from their results."""

    def __init__(self, station: Station, flush: Callable[[], None]) -> None:
        self._station = station
        self._flush = flush
        self._worker = Worker("disk", 0)

    def run(self) -> None:
        """Run what the station wants of the disk."""
        loop = asyncio.get_running_loop()
        for job in self._station.services.pop_disk_jobs():
            self._worker.submit(partial(self._work, job, loop))

    def close(self) -> None:
        """Keep what has arrived of all transfers, and wait until it is written."""
        self._station.services.cancel_transfers(asyncio.get_running_loop().time())
        self.run()
        self._worker.close(CLOSE_WITHIN)

    def _take(self, result: DiskResult) -> None:
        self._station.services.handle_disk(result, asyncio.get_running_loop().time())
        self.run()
        self._flush()

    def _work(self, job: DiskJob, loop: asyncio.AbstractEventLoop) -> None:
        result = run_job(job)
        with contextlib.suppress(RuntimeError):  # the loop has ended
            loop.call_soon_threadsafe(self._take, result)
