"""TaskList: the requests to vehicles that run and have just ended, with how fast they go. Time is an argument."""

from __future__ import annotations

from collections import deque

import msgspec

from groundstation.views.requests import RequestLine, RequestsView

SERVICES = frozenset({"files", "params", "plans", "export"})
"""Services whose requests take long enough to be listed."""

WINDOW = 5.0
"""s over which the speed is measured."""

SHOWN_ENDED = 4
"""Requests that have ended and are still listed."""


class Speed(msgspec.Struct, frozen=True):
    """How fast a transfer goes."""

    per_second: float
    left: float | None
    """s until the end; None: not known."""


class TaskList:
    """Takes views of the requests; the newest comes first."""

    def __init__(self) -> None:
        self.running: tuple[RequestLine, ...] = ()
        self.ended: tuple[RequestLine, ...] = ()
        self._view = RequestsView((), ())
        self._local: tuple[RequestLine, ...] = ()
        """Requests of this process: exports."""
        self._samples: dict[int, deque[tuple[float, int]]] = {}
        self._known: set[int] = set()
        self._fresh: list[int] = []

    def show(self, view: RequestsView, now: float) -> None:
        """Show a view."""
        self._view = view
        self._update(now)

    def show_local(self, lines: tuple[RequestLine, ...], now: float) -> None:
        """Show the jobs of this process that run or have ended."""
        if lines != self._local:
            self._local = lines
            self._update(now)

    def _update(self, now: float) -> None:
        view, local = self._view, self._local
        running = (*view.running, *(line for line in local if line.state == "running"))
        self.running = tuple(line for line in reversed(running) if line.service in SERVICES)
        all_ended = (*view.ended, *(line for line in local if line.state != "running"))
        ended = [line for line in reversed(all_ended) if line.service in SERVICES]
        self._fresh += [line.number for line in ended if line.number not in self._known]
        self._known = {line.number for line in ended}
        self.ended = tuple(sorted(ended, key=lambda line: -line.number)[:SHOWN_ENDED])
        self._samples = {line.number: self._sample(line, now) for line in self.running}

    @property
    def lines(self) -> tuple[RequestLine, ...]:
        """What runs, then what has ended."""
        return (*self.running, *self.ended)

    def pop_ended(self) -> list[int]:
        """Return the numbers of requests that have ended since the last call."""
        fresh, self._fresh = self._fresh, []
        return fresh

    def find(self, what: str, system: int) -> RequestLine | None:
        """Return the running request with this text to a vehicle."""
        return next((line for line in self.running if line.what == what and line.system == system), None)

    def speed(self, line: RequestLine) -> Speed | None:
        """Return how fast a request goes; None until that is known."""
        samples = self._samples.get(line.number)
        if not samples or samples[-1][0] - samples[0][0] < 0.5:
            return None
        rate = (samples[-1][1] - samples[0][1]) / (samples[-1][0] - samples[0][0])
        left = (line.total - line.done) / rate if rate > 0 and line.total else None
        return Speed(max(0.0, rate), left)

    def _sample(self, line: RequestLine, now: float) -> deque[tuple[float, int]]:
        samples = self._samples.get(line.number, deque())
        if line.done:
            samples.append((now, line.done))
        while samples and now - samples[0][0] > WINDOW:
            samples.popleft()
        return samples
