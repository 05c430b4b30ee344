"""Compares files of one vehicle with files of this machine, by their checksums. Sans I/O: see disk_jobs.py."""

from __future__ import annotations

from pathlib import PurePath

import msgspec

from groundstation.intents.files import DIFFERS, SAME
from groundstation.vehicles.requests.disk_jobs import DiskJob, DiskResult, DiskWork
from groundstation.vehicles.requests.file_requests import FileRequests
from groundstation.vehicles.requests.requests import RequestBook, RequestReport, RequestState

FIRST_STEP = -2_000_000
"""Numbers of the steps of comparisons count down from here, below those of transfers."""


class _Comparison(msgspec.Struct):
    number: int
    path: str
    """On the vehicle."""
    here: int = 0
    """CRC-32 of the file of this machine, once it was read."""


class FileComparing:
    """All comparisons of one vehicle: the file here is read first, then the vehicle computes its checksum."""

    def __init__(self, files: FileRequests, book: RequestBook) -> None:
        self._files = files
        self._book = book
        self._running: dict[int, _Comparison] = {}
        self._steps: dict[int, int] = {}
        """Step -> request."""
        self._count = FIRST_STEP
        self._jobs: list[DiskJob] = []

    def compare(self, number: int, path: str, file: str, now: float) -> None:
        """Compare `path` of the vehicle with `file` of this machine."""
        if self._book.begin(number, f"compare {path} with {PurePath(file).name}"):
            self._running[number] = _Comparison(number, path)
            self._jobs.append(DiskJob(number, DiskWork.CHECKSUM, file))

    def cancel(self, number: int, now: float) -> None:
        """Cancel a comparison."""
        if self._running.pop(number, None) is None:
            return
        for step in [step for step, request in self._steps.items() if request == number]:
            del self._steps[step]
            self._files.cancel(step, now)
        self._book.cancel(number)

    def pop_disk_jobs(self) -> list[DiskJob]:
        """Return what the disk shall do, once."""
        jobs, self._jobs = self._jobs, []
        return jobs

    def handle_disk(self, result: DiskResult, now: float) -> None:
        """Store the checksum of the file here, and request that of the vehicle."""
        comparison = self._running.get(result.number)
        if comparison is None:
            return
        if result.problem:
            del self._running[result.number]
            self._book.refuse(result.number, result.problem, now, by_vehicle=False)
            return
        comparison.here = result.checksum
        self._count -= 1
        self._steps[self._count] = result.number
        self._files.checksum(self._count, comparison.path, now)

    def handle_report(self, report: RequestReport, now: float) -> None:
        """End the comparison whose checksum has come, or was refused."""
        if not report.state.ended or report.number not in self._steps:
            return
        comparison = self._running.pop(self._steps.pop(report.number))
        outcome = self._files.pop_result(report.number)
        if report.state is RequestState.NO_ANSWER:
            self._book.fail(comparison.number, report.detail)
        elif report.state is not RequestState.ACCEPTED or outcome is None or outcome.checksum is None:
            detail = report.reason or report.detail or "the vehicle computes no checksums"
            self._book.refuse(comparison.number, detail, now, by_vehicle=False)
        else:
            self._book.accept(comparison.number, describe(comparison.here, outcome.checksum))


def describe(here: int, there: int) -> str:
    """Return the result of a comparison; it begins with SAME or DIFFERS."""
    if here == there:
        return f"{SAME}: CRC {here:08x}"
    return f"{DIFFERS}: CRC {there:08x} there, {here:08x} here"
