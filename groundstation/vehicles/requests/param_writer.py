"""Writes several parameters of one vehicle, one after the other; stops at the first that is not set."""

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
        done = write.total - len(write.left)
        if report.state is RequestState.ACCEPTED:
            self._book.advance(write.number, done, write.total)
            self._next(write, now)
            return
        self._write = None
        self._book.advance(write.number, done - 1, write.total)
        text = f"{report.reason or f'{write.name}: {report.detail}'} ({done - 1} of {write.total} set)"
        if report.state is RequestState.NO_ANSWER:
            self._book.fail(write.number, text)
        else:
            self._book.refuse(write.number, text, now, by_vehicle=False)

    def _next(self, write: _Write, now: float) -> None:
        if not write.left:
            self._write = None
            self._book.accept(write.number)
            return
        name, value = write.left.popleft()
        self._count += 1
        write.current, write.name = -self._count, name
        self._params.set(write.current, name, value, now)
