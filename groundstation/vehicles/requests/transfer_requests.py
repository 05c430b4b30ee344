"""Downloads into files of this machine and uploads from them, as requests of one vehicle. Sans I/O: see disk_jobs.py.

A download first reads what an earlier one left, resumes behind it, keeps what has arrived every few seconds, and is
written under its name only when it is whole. If the vehicle is lost meanwhile, it goes on when the vehicle is back.
"""

from __future__ import annotations

from collections.abc import Callable
from enum import Enum, auto

import msgspec

from dialects.enums import Autopilot
from groundstation.vehicles.requests.disk_jobs import DiskJob, DiskResult, DiskWork, name_problem
from groundstation.vehicles.requests.file_requests import FileRequests
from groundstation.vehicles.requests.log_requests import LogRequests
from groundstation.vehicles.requests.requests import FIRST_STEP, RequestBook, RequestReport, RequestState
from link.services.ftp.job import FtpOutcome
from link.services.log.client import RemoteLog

KEEP_PERIOD = 5.0
"""s between two times that what has arrived is kept: a killed station loses no more."""

LOG_FOLDER = "/logs"
"""Where our vehicle serves its logs by MAVLink FTP, in the order of the log protocol."""


class _Phase(Enum):
    DISK = auto()
    LOCATE = auto()
    MOVE = auto()
    """The data are on their way."""
    WAIT = auto()
    """For the vehicle to be back."""


class _Transfer(msgspec.Struct):
    number: int
    remote: str
    """Path on the vehicle; "" for a log that has none."""
    local: str
    log: RemoteLog | None = None
    upload: bool = False
    phase: _Phase = _Phase.DISK
    step: int = 0
    data: bytes = b""
    """What is kept of a download, or the file to upload."""
    from_start: bool = False
    """It was begun anew, because what was kept did not fit."""
    keep_due: float = 0.0

    @property
    def resumable(self) -> bool:
        """A file that the vehicle makes anew each time is not."""
        return not self.remote.lstrip("/").startswith("@")


def log_ending(autopilot: int) -> str:
    """Return the ending of a vehicle's log: ULog of PX4, else .bin."""
    return ".ulg" if autopilot == Autopilot.PX4 else ".bin"


def log_path(listed: FtpOutcome | None, log: RemoteLog) -> str | None:
    """Return the path of a log of our vehicle in the list of LOG_FOLDER; None if it is not at its place there."""
    files = [entry for entry in listed.entries if entry.size is not None] if listed is not None else []
    if log.number >= len(files) or (files[log.number].size or 0) < log.size:
        return None
    return f"{LOG_FOLDER}/{files[log.number].name}"


class TransferRequests:
    """All transfers of one vehicle. `vehicle` returns whether it is heard, and its MAV_AUTOPILOT."""

    def __init__(
        self, files: FileRequests, logs: LogRequests, book: RequestBook, vehicle: Callable[[], tuple[bool, int]]
    ) -> None:
        self._files = files
        self._logs = logs
        self._book = book
        self._vehicle = vehicle
        self._transfers: dict[int, _Transfer] = {}
        self._steps: dict[int, int] = {}
        """Step -> request."""
        self._count = FIRST_STEP
        self._jobs: list[DiskJob] = []

    # ---- requests ----

    def get_file(self, number: int, path: str, folder: str, name: str, now: float, *, overwrite: bool) -> None:
        """Download a file."""
        if self._book.begin(number, f"download {path}"):
            self._prepare(_Transfer(number, path, f"{folder}/{name}"), name, now, overwrite=overwrite)

    def get_log(self, number: int, log: int, folder: str, name: str, now: float, *, overwrite: bool) -> None:
        """Download a log of the newest list."""
        if not self._book.begin(number, f"download log {log}"):
            return
        found = next((each for each in self._logs.logs or () if each.number == log), None)
        if found is None:
            self._book.refuse(number, f"there is no log {log} in the list", now, by_vehicle=False)
            return
        self._prepare(_Transfer(number, "", f"{folder}/{name}", found), name, now, overwrite=overwrite)

    def put_file(self, number: int, path: str, file: str, now: float) -> None:
        """Upload a file."""
        if self._book.begin(number, f"upload {path}"):
            self._transfers[number] = _Transfer(number, path, file, upload=True)
            self._jobs.append(DiskJob(number, DiskWork.READ, file))

    def cancel(self, number: int, now: float) -> None:
        """Cancel a transfer; what has arrived is kept."""
        transfer = self._transfers.pop(number, None)
        if transfer is None:
            return
        self._keep(transfer)
        self._leave(transfer, now)
        self._book.cancel(number)

    def cancel_all(self, now: float) -> None:
        """Cancel all transfers, when the station ends."""
        for number in list(self._transfers):
            self.cancel(number, now)

    # ---- the disk ----

    def pop_disk_jobs(self) -> list[DiskJob]:
        """Return what the disk shall do, once."""
        jobs, self._jobs = self._jobs, []
        return jobs

    def handle_disk(self, result: DiskResult, now: float) -> None:
        """Go on with what the disk has answered."""
        transfer = self._transfers.get(result.number)
        if transfer is None or result.work is DiskWork.KEEP:
            return
        if result.problem:
            self._end(transfer, RequestState.REFUSED, result.problem, now)
        elif result.work is DiskWork.STORE:
            self._end(transfer, RequestState.ACCEPTED, f"saved to {transfer.local}", now)
        else:
            transfer.data = result.data
            self._begin(transfer, now)

    # ---- time and reports ----

    def tick(self, now: float) -> None:
        """Keep what has arrived; go on with a vehicle that is back."""
        if not self._transfers:
            return
        alive, _ = self._vehicle()
        for transfer in list(self._transfers.values()):
            if transfer.phase is _Phase.WAIT and alive:
                self._begin(transfer, now)
            elif transfer.phase is _Phase.MOVE and not transfer.upload and now >= transfer.keep_due:
                transfer.keep_due = now + KEEP_PERIOD
                self._keep(transfer)

    def waits(self, number: int) -> bool:
        """Return whether a transfer waits for its vehicle to be back."""
        transfer = self._transfers.get(number)
        return transfer is not None and transfer.phase is _Phase.WAIT

    def handle_report(self, report: RequestReport, now: float) -> None:
        """Go on with a step that has ended, and pass its progress on."""
        transfer = self._transfers.get(self._steps.get(report.number, 0))
        if transfer is None or transfer.step != report.number:
            return
        if not report.state.ended:
            if transfer.phase is _Phase.MOVE:
                self._book.advance(transfer.number, report.done, report.total, report.detail)
            return
        self._steps.pop(report.number, None)
        if transfer.phase is _Phase.LOCATE:
            self._located(transfer, now)
        elif transfer.upload:
            self._end(transfer, report.state, report.reason or report.detail, now)
        else:
            self._fetched(transfer, report, now)

    # ---- parts ----

    def _prepare(self, transfer: _Transfer, name: str, now: float, *, overwrite: bool) -> None:
        if problem := name_problem(name):
            self._book.refuse(transfer.number, problem, now, by_vehicle=False)
        elif any(each.local == transfer.local for each in self._transfers.values()):
            self._book.refuse(transfer.number, f"{name} is being downloaded already", now, by_vehicle=False)
        else:
            self._transfers[transfer.number] = transfer
            self._jobs.append(DiskJob(transfer.number, DiskWork.PREPARE, transfer.local, overwrite=overwrite))

    def _begin(self, transfer: _Transfer, now: float) -> None:
        """Request the data, or for a log of our vehicle first its name: by FTP it is faster, and has a checksum."""
        step = self._next_step(transfer)
        transfer.phase, transfer.keep_due = _Phase.MOVE, now + KEEP_PERIOD
        if transfer.upload:
            self._files.upload(step, transfer.remote, transfer.data, now)
        elif transfer.remote:
            self._files.download(step, transfer.remote, now, transfer.data if transfer.resumable else b"")
        elif transfer.log is not None and self._vehicle()[1] == Autopilot.GENERIC and not transfer.from_start:
            transfer.phase = _Phase.LOCATE
            self._files.list_folder(step, LOG_FOLDER, now)
        elif transfer.log is not None:
            self._logs.download(step, transfer.log, now, transfer.data)

    def _located(self, transfer: _Transfer, now: float) -> None:
        """Choose FTP if the list of the folder has the log at its place, else LOG_DATA."""
        outcome = self._files.pop_result(transfer.step)
        path = log_path(outcome, transfer.log) if transfer.log is not None else None
        transfer.remote, transfer.from_start = path or "", path is None  # no more FTP for one that has none
        self._begin(transfer, now)

    def _fetched(self, transfer: _Transfer, report: RequestReport, now: float) -> None:
        data = self._pop_data(transfer)
        if report.state is RequestState.ACCEPTED:
            transfer.phase = _Phase.DISK
            self._jobs.append(DiskJob(transfer.number, DiskWork.STORE, transfer.local, data))
        elif report.state is RequestState.REFUSED and transfer.data and not transfer.from_start:
            transfer.data, transfer.from_start = b"", True  # what was kept is of another file, or an older state of it
            self._begin(transfer, now)
        else:
            transfer.data = max(transfer.data, data, key=len)
            self._keep(transfer)
            if report.state is RequestState.NO_ANSWER and not self._vehicle()[0]:
                transfer.phase = _Phase.WAIT
            else:
                self._end(transfer, report.state, report.reason or report.detail, now)

    def _pop_data(self, transfer: _Transfer) -> bytes:
        if transfer.remote:
            outcome = self._files.pop_result(transfer.step)
            return outcome.data if outcome is not None else b""
        return self._logs.pop_data(transfer.step)

    def _keep(self, transfer: _Transfer) -> None:
        """Keep what has arrived, if it is more than what was kept."""
        if transfer.upload or not transfer.resumable:
            return
        source = self._files if transfer.remote else self._logs
        data = max(transfer.data, source.beginning_of(transfer.step), key=len)
        if data and (len(data) > len(transfer.data) or transfer.phase is not _Phase.MOVE):
            transfer.data = data
            self._jobs.append(DiskJob(transfer.number, DiskWork.KEEP, transfer.local, data))

    def _end(self, transfer: _Transfer, state: RequestState, detail: str, now: float) -> None:
        self._transfers.pop(transfer.number, None)
        if not transfer.upload and transfer.data and state is not RequestState.ACCEPTED and transfer.resumable:
            detail = f"{detail} ({len(transfer.data)} bytes kept, the next download goes on there)"
        if state is RequestState.ACCEPTED:
            self._book.accept(transfer.number, detail)
        elif state is RequestState.NO_ANSWER:
            self._book.fail(transfer.number, detail)
        else:
            self._book.refuse(transfer.number, detail, now, by_vehicle=False)

    def _leave(self, transfer: _Transfer, now: float) -> None:
        self._steps.pop(transfer.step, None)
        self._files.cancel(transfer.step, now)
        self._logs.cancel(transfer.step, now)

    def _next_step(self, transfer: _Transfer) -> int:
        self._count -= 1
        transfer.step = self._count
        self._steps[transfer.step] = transfer.number
        return transfer.step
