"""The files of one vehicle by MAVLink FTP: listed, downloaded, uploaded, removed; shared with other requests."""

from __future__ import annotations

from collections.abc import Callable

from groundstation.vehicles.requests.requests import RequestBook, describe_holes
from link.core import Received
from link.services.ftp.client import FtpClient
from link.services.ftp.job import TRIES, FtpOutcome

MAX_RESULTS = 8
"""Outcomes that are kept for whoever requested them; the oldest goes first."""

OutcomeHandler = Callable[[FtpOutcome, float], None]


class FileRequests:
    """Requests about files. Each ends in the book, and `results` keeps its outcome until it is taken."""

    def __init__(self, client: FtpClient, book: RequestBook) -> None:
        self._client = client
        self._book = book
        self._handlers: dict[int, OutcomeHandler] = {}
        """FTP job -> who wants its outcome."""
        self._jobs: dict[int, int] = {}
        """Request -> its FTP job."""
        self._results: dict[int, FtpOutcome] = {}

    # ---- requests ----

    def list_folder(self, number: int, path: str, now: float) -> None:
        """List a folder."""
        if self._book.begin(number, f"list {path}"):
            self._follow(number, self._client.list_folder(path, now), now)

    def download(self, number: int, path: str, now: float, have: bytes = b"") -> None:
        """Download a file and compare its checksum; `have` is its beginning, from an earlier download."""
        if self._book.begin(number, f"download {path}"):
            self._follow(number, self._client.download(path, now, have=have, verify=True), now)

    def upload(self, number: int, path: str, data: bytes, now: float) -> None:
        """Create or replace a file and compare its checksum."""
        if self._book.begin(number, f"upload {path}"):
            self._follow(number, self._client.upload(path, data, now), now)

    def remove(self, number: int, path: str, now: float) -> None:
        """Remove a file."""
        if self._book.begin(number, f"remove {path}"):
            self._follow(number, self._client.remove(path, now), now)

    def checksum(self, number: int, path: str, now: float) -> None:
        """Have the vehicle compute the checksum of a file."""
        if self._book.begin(number, f"checksum of {path}"):
            self._follow(number, self._client.checksum(path, now), now)

    def cancel(self, number: int, now: float) -> None:
        """Cancel a request."""
        job = self._jobs.pop(number, None)
        if job is not None:
            self.cancel_job(job, now)
            self._book.cancel(number)

    def pop_result(self, number: int) -> FtpOutcome | None:
        """Return the outcome of a request that has ended, once."""
        return self._results.pop(number, None)

    def beginning_of(self, number: int) -> bytes:
        """Return what has arrived of a request without a gap from the start; nothing if it is not under way."""
        job = self._jobs.get(number)
        return self._client.beginning if job is not None and job == self._client.number else b""

    # ---- for other requests ----

    def start_download(self, path: str, handler: OutcomeHandler, now: float, *, patience: int = TRIES) -> int:
        """Download a file for another request; return the number of the FTP job."""
        job = self._client.download(path, now, patience=patience)
        self._handlers[job] = handler
        return job

    def cancel_job(self, job: int, now: float) -> None:
        """Cancel an FTP job."""
        self._handlers.pop(job, None)
        self._client.cancel(job, now)

    def progress_of(self, job: int) -> tuple[int, int | None]:
        """Return how far an FTP job is, bytes."""
        return self._client.progress if self._client.number == job else (0, None)

    # ---- core ----

    def receive(self, received: Received, now: float) -> None:
        """Handle a message of the vehicle."""
        self._client.receive(received, now)
        self._handle_outcomes(now)

    def tick(self, now: float) -> None:
        """Repeat what is overdue, report progress."""
        self._client.tick(now)
        self._handle_outcomes(now)
        for number, job in self._jobs.items():
            if job == self._client.number:
                self._book.advance(number, *self._client.progress, describe_holes(self._client.holes))

    def _follow(self, number: int, job: int, now: float) -> None:
        self._jobs[number] = job
        self._handlers[job] = lambda outcome, later: self._end(number, outcome, later)
        self._handle_outcomes(now)  # one that cannot be sent has ended already

    def _handle_outcomes(self, now: float) -> None:
        for outcome in self._client.outcomes():
            handler = self._handlers.pop(outcome.number, None)
            if handler is not None:
                handler(outcome, now)

    def _end(self, number: int, outcome: FtpOutcome, now: float) -> None:
        self._jobs.pop(number, None)
        self._results[number] = outcome
        if len(self._results) > MAX_RESULTS:
            del self._results[next(iter(self._results))]
        if outcome.done:
            self._book.accept(number)
        elif outcome.error is None and outcome.problem.startswith("no answer"):
            self._book.fail(number, outcome.problem.removeprefix("no answer "))
        else:
            self._book.refuse(number, outcome.problem, now, by_vehicle=outcome.error is not None)
