"""Writes several parameters of one vehicle, one after the other.

A value that the vehicle keeps as it is, such as a read-only one, stops no other: a file of another vehicle has some.
Every other refusal would meet the rest, too, and ends the write.
"""

from __future__ import annotations

from collections import deque

import msgspec

from groundstation.vehicles.requests.param_requests import ParamRequests
from groundstation.vehicles.requests.requests import RequestBook, RequestReport, RequestState

MAX_CHANGES = 2000
"""Parameters of one request; more than any vehicle has."""


class _Write(msgspec.Struct):
    """A request under way. Its sets are requests of their own, with numbers below 0."""

    number: int
    left: deque[tuple[str, float]]
    total: int
    current: int = 0
    """Number of the set under way."""
    name: str = ""
    """Its parameter."""
    kept: list[str] = msgspec.field(default_factory=list)
    """Parameters that the vehicle keeps as they are."""

    @property
    def tried(self) -> int:
        """How many have been sent."""
        return self.total - len(self.left)


class ParamWriter:
    """Requests that set several parameters, one of them at a time."""

    def __init__(self, params: ParamRequests, book: RequestBook) -> None:
        self._params = params
        self._book = book
        self._write: _Write | None = None
        self._count = 0

    def write(self, number: int, changes: tuple[tuple[str, float], ...], now: float) -> None:
        """Set these parameters."""
        what = "set 1 parameter" if len(changes) == 1 else f"set {len(changes)} parameters"
        if not self._book.begin(number, what):
            return
        if self._write is not None or not 0 < len(changes) <= MAX_CHANGES:
            text = "parameters are being set already" if self._write else "there is nothing to set, or too much"
            self._book.refuse(number, text, now, by_vehicle=False)
            return
        self._write = _Write(number, deque(changes), len(changes))
        self._next(self._write, now)

    def cancel(self, number: int, now: float) -> None:
        """Set no further parameters; the one under way may still be set."""
        if self._write is not None and self._write.number == number:
            self._write = None
            self._book.cancel(number)

    def handle_report(self, report: RequestReport, now: float) -> None:
        """Go on when a set has ended; end the request when one was not accepted."""
        write = self._write
        if write is None or report.number != write.current or not report.state.ended:
            return
        if report.kept:
            self._book.keep(write.number, *report.kept)
            write.kept += report.kept
        if report.state is RequestState.ACCEPTED or report.kept:
            self._book.advance(write.number, write.tried, write.total)
            self._next(write, now)
            return
        self._write = None
        done = write.tried - 1
        self._book.advance(write.number, done, write.total)
        text = f"{report.reason or f'{write.name}: {report.detail}'} ({done - len(write.kept)} of {write.total} set)"
        if report.state is RequestState.NO_ANSWER:
            self._book.fail(write.number, text)
        else:
            self._book.refuse(write.number, text, now, by_vehicle=False)

    def _next(self, write: _Write, now: float) -> None:
        if not write.left:
            self._write = None
            self._end(write, now)
            return
        name, value = write.left.popleft()
        self._count += 1
        write.current, write.name = -self._count, name
        self._params.set(write.current, name, value, now)

    def _end(self, write: _Write, now: float) -> None:
        """End a request after its last parameter."""
        if not write.kept:
            self._book.accept(write.number)
            return
        text = f"kept by the vehicle: {', '.join(write.kept)} ({write.total - len(write.kept)} of {write.total} set)"
        self._book.refuse(write.number, text, now, by_vehicle=False)
