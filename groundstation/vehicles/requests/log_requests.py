"""The logs of one vehicle by LOG_REQUEST_LIST and LOG_DATA, for vehicles without MAVLink FTP."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable

from groundstation.vehicles.requests.requests import RequestBook, describe_holes
from link.core import Received
from link.services.log.client import LogClient, LogOutcome, RemoteLog

MAX_LEFT = 1
"""Logs that stay after all were erased: the one that is being written."""

_Begin = Callable[[float], None]


class LogRequests:
    """Requests about logs, one after the other. `logs` is the newest list; None: not known."""

    def __init__(self, client: LogClient, book: RequestBook) -> None:
        self._client = client
        self._book = book
        self.logs: tuple[RemoteLog, ...] | None = None
        self._jobs: deque[tuple[int, _Begin]] = deque()
        self._number: int | None = None
        """Request under way."""
        self._data: dict[int, bytes] = {}
        self._erasing: set[int] = set()
        """Requests that erase, and list then."""

    def list_logs(self, number: int, now: float) -> None:
        """Request the list."""
        if self._book.begin(number, "list logs"):
            self._add(number, self._client.list_logs, now)

    def download(self, number: int, log: RemoteLog, now: float, have: bytes = b"") -> None:
        """Download a log; `have` is its beginning, from an earlier download."""
        if self._book.begin(number, f"download log {log.number}"):
            self._add(number, lambda later: self._client.download(log, later, have), now)

    def erase(self, number: int, now: float) -> None:
        """Erase all logs; as nothing answers that, the list shows afterwards whether it was done."""
        if self._book.begin(number, "erase all logs"):
            self._erasing.add(number)
            self._add(number, self._client.erase, now)

    def cancel(self, number: int, now: float) -> None:
        """Cancel a request."""
        self._erasing.discard(number)
        if number == self._number:
            self._client.cancel()
            self._number = None
        elif all(job[0] != number for job in self._jobs):
            return
        self._jobs = deque(job for job in self._jobs if job[0] != number)
        self._book.cancel(number)
        self._begin_next(now)

    def pop_data(self, number: int) -> bytes:
        """Return what a download that has ended brought, once."""
        return self._data.pop(number, b"")

    def beginning_of(self, number: int) -> bytes:
        """Return what has arrived of a request without a gap from the start; nothing if it is not under way."""
        return self._client.beginning if number == self._number else b""

    def receive(self, received: Received, now: float) -> None:
        """Handle a message of the vehicle."""
        self._client.receive(received, now)
        self._handle_outcomes(now)

    def tick(self, now: float) -> None:
        """Request again what is missing, report progress."""
        self._client.tick(now)
        self._handle_outcomes(now)
        if self._number is not None:
            holes = describe_holes(self._client.holes)
            self._book.advance(self._number, *self._client.progress, holes)

    def _add(self, number: int, begin: _Begin, now: float) -> None:
        self._jobs.append((number, begin))
        self._begin_next(now)

    def _begin_next(self, now: float) -> None:
        if self._number is None and self._jobs:
            self._number, begin = self._jobs.popleft()
            begin(now)
            self._handle_outcomes(now)  # an empty log is there at once

    def _handle_outcomes(self, now: float) -> None:
        for outcome in self._client.outcomes():
            number, self._number = self._number, None
            if number is not None:
                self._end(number, outcome, now)
            self._begin_next(now)

    def _end(self, number: int, outcome: LogOutcome, now: float) -> None:
        erased = number in self._erasing
        self._erasing.discard(number)
        before = self.logs
        if outcome.log is None and outcome.done:
            self.logs = outcome.logs
        else:
            self._data = {number: outcome.data}  # only the newest is kept
        if erased and outcome.done and len(outcome.logs) > MAX_LEFT and len(outcome.logs) >= len(before or ()):
            self._book.refuse(number, f"{len(outcome.logs)} logs are still there", now)
        elif erased and outcome.done:
            self._book.accept(number, f"{len(outcome.logs)} left" if outcome.logs else "")
        elif outcome.done:
            self._book.accept(number)
        else:
            self._book.fail(number, f"after {outcome.tries} tries")
