"""Requests to one vehicle: each has a number, and ends accepted, refused with the reason, or without an answer."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from enum import Enum
from typing import NamedTuple

import msgspec
from msgspec.structs import replace

from groundstation.vehicles.state.reason_texts import MORE_WITHIN, REASON_WITHIN, ReasonTexts

FIRST_STEP = -1_000_000
"""Numbers from here down are steps of other requests: their reports go to nobody else."""
MAX_REQUESTS = 1000
"""Requests under way at once; more are refused."""


class RequestState(Enum):
    """How a request stands."""

    RUNNING = "running"
    ACCEPTED = "accepted"
    REFUSED = "refused"
    NO_ANSWER = "no answer"
    CANCELLED = "cancelled"

    @property
    def ended(self) -> bool:
        """Whether nothing more follows."""
        return self is not RequestState.RUNNING


class RequestReport(msgspec.Struct, frozen=True):
    """How one request stands."""

    number: int
    """Chosen by whoever made the request."""
    what: str
    """What was requested, e.g. "set FS_ACTION to 2"."""
    state: RequestState = RequestState.RUNNING
    detail: str = ""
    """Why it was refused, or what came of it."""
    reason: str = ""
    """STATUSTEXT of the vehicle that explains a refusal."""
    answer: int | None = None
    """Why it was refused, as a number: MAV_RESULT of a command, MAV_PARAM_ERROR of a parameter; None: neither.

    The latter also where the request cannot be encoded and nothing was sent."""
    done: int = 0
    total: int | None = None
    """Items or bytes that were transferred, and all, where known."""
    kept: tuple[str, ...] = ()
    """Parameters that the vehicle keeps as they are, e.g. read-only ones. Others may be set all the same."""

    @property
    def text(self) -> str:
        """One line: what was requested, how it ended, and why."""
        parts = [f"{self.what}: {self.state.value}", self.detail, f'"{self.reason}"' if self.reason else ""]
        return ", ".join(part for part in parts if part)


class _Refusal(NamedTuple):
    at: float
    until: float
    name: str


class RequestBook:
    """The requests to one vehicle, and its texts that explain refusals."""

    def __init__(self) -> None:
        self._running: dict[int, RequestReport] = {}
        self._refused: dict[int, _Refusal] = {}
        """Refusals that wait for a reason."""
        self._changed: dict[int, RequestReport] = {}
        self._reasons = ReasonTexts()
        self._texts_before: dict[int, int] = {}
        """Number of a request -> how many texts the vehicle had said when it began."""
        self._refusal = ""
        self.busy = ""
        """Why the vehicle refuses most of what is requested now; "" for no such reason."""

    @property
    def running(self) -> tuple[RequestReport, ...]:
        """The requests that have not ended."""
        return tuple(self._running.values())

    def begin(self, number: int, what: str) -> bool:
        """Begin a request. Return False, and report it as refused, if its number is in use or too many run."""
        report = RequestReport(number, what)
        if number in self._running or len(self._running) >= MAX_REQUESTS:
            detail = "its number is in use" if number in self._running else "too many requests"
            self._changed[number] = replace(report, state=RequestState.REFUSED, detail=detail)
            return False
        self._running[number] = self._changed[number] = report
        self._texts_before[number] = self._reasons.count
        return True

    def advance(self, number: int, done: int, total: int | None, detail: str = "") -> None:
        """Report progress, and what there is to say of it."""
        report = self._running.get(number)
        if report is None or number in self._refused:
            return
        if (report.done, report.total, report.detail) != (done, total, detail):
            self._running[number] = self._changed[number] = replace(report, done=done, total=total, detail=detail)

    def keep(self, number: int, *names: str) -> None:
        """Note parameters that the vehicle keeps as they are; the request goes on."""
        if (report := self._running.get(number)) is not None:
            self._running[number] = replace(report, kept=(*report.kept, *names))

    def accept(self, number: int, detail: str = "") -> None:
        """End a request as accepted."""
        self._end(number, RequestState.ACCEPTED, detail)

    def refuse(
        self,
        number: int,
        detail: str,
        now: float,
        *,
        by_vehicle: bool = True,
        name: str = "",
        answer: int | None = None,
    ) -> None:
        """End a request as refused; `by_vehicle`: with the vehicle's STATUSTEXT, for which it waits REASON_WITHIN.

        `name`: the parameter that is refused. Texts that name it explain it, in place of those about its neighbours.
        `answer`: see RequestReport.
        """
        report = self._running.get(number)
        if report is None:
            return
        self._running[number] = report = replace(report, answer=answer)
        if not by_vehicle or self.busy:
            why = f": {self.busy}" if by_vehicle else ""
            self._end(number, RequestState.REFUSED, f"{detail}{why}")
            return
        self._running[number] = replace(report, detail=detail)
        said = self._reasons.explain(now, self._texts_before[number], name)
        self._refused[number] = _Refusal(now, now + (MORE_WITHIN if said else REASON_WITHIN), name)

    def fail(self, number: int, detail: str) -> None:
        """End a request without an answer; `detail` names the tries."""
        self._end(number, RequestState.NO_ANSWER, detail)

    def cancel(self, number: int) -> None:
        """End a request because the operator wants it no more."""
        if self._refusal:
            self._end(number, RequestState.REFUSED, self._refusal)
        else:
            self._end(number, RequestState.CANCELLED, "")

    @contextmanager
    def refusing(self, why: str) -> Iterator[None]:
        """Make what is cancelled in this block end as refused, because its messages are not sent."""
        self._refusal = why
        try:
            yield
        finally:
            self._refusal = ""

    def handle_text(self, text: str, severity: int, now: float) -> None:
        """Handle a STATUSTEXT of the vehicle. It may explain the refusals around it, and others may follow it."""
        if self._reasons.add(text, severity, now):
            for number, each in self._refused.items():
                self._refused[number] = each._replace(until=min(each.until, now + MORE_WITHIN))

    def tick(self, now: float) -> None:
        """End the refusals for which no further reason is waited."""
        for number, (at, until, name) in list(self._refused.items()):
            if now >= until:
                reason = self._reasons.explain(at, self._texts_before[number], name)
                self._running[number] = replace(self._running[number], reason=reason)
                self._end(number, RequestState.REFUSED, self._running[number].detail)

    def pop_changes(self) -> list[RequestReport]:
        """Return the newest report of each request that has changed since the last call."""
        changed, self._changed = self._changed, {}
        return list(changed.values())

    def _end(self, number: int, state: RequestState, detail: str) -> None:
        report = self._running.pop(number, None)
        self._refused.pop(number, None)
        self._texts_before.pop(number, None)
        if report is not None:
            self._changed[number] = replace(report, state=state, detail=detail)


def describe_holes(holes: int) -> str:
    """Return how many gaps a transfer has, which are requested again."""
    return "" if not holes else "1 hole" if holes == 1 else f"{holes} holes"
