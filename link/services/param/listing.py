"""The list of a vehicle's parameters: which indexes have arrived, which to request, when to give up.

Source: https://mavlink.io/en/services/parameter.html.
"""

from __future__ import annotations

import heapq
from collections import Counter

from dialects import messages as m
from link.core import Outgoing

LIST_TIMEOUT = 1.0
"""s without a new parameter before gaps are filled: a 57600 baud radio with telemetry takes 0.3 s per value."""
GAP_TIMEOUT = 0.7
"""s without an answer before gaps are requested again: ArduPilot answers a read in 0.1 s, a radio adds 0.4 s."""
TRIES = 8
"""Requests in turn without a new parameter before the list is given up. At 30 % loss each way all fail once in 218."""
WINDOW = 10
"""Gaps requested at once: 320 bytes, a twentieth of a second of a 57600 baud radio."""
LIST_AGAIN = 100
"""Gaps above which the whole list is faster than single reads, which ArduPilot answers ten a second."""
MAX_LISTS = 3
"""Requests for the whole list in turn, once the first value has arrived."""
MAX_COUNT_CHANGES = 8
"""Changes of `param_count` in one list. Enabling a feature of ArduPilot changes it once; more never ends."""


class ParamListing:
    """One list of a vehicle (`target`: system and component)."""

    def __init__(self, target: tuple[int, int]) -> None:
        self._target = target
        self.active = False
        self.total: int | None = None
        """Number of parameters that the vehicle reports; None: not known."""
        self.problem: str | None = None
        """Why the list ended incomplete."""
        self.received: set[int] = set()
        """Indexes that have arrived."""
        self._filling = False
        """The end of the list has been waited for: gaps are requested."""
        self._reset(0.0)

    @property
    def complete(self) -> bool:
        """Whether every parameter has arrived."""
        return self.total is not None and len(self.received) >= self.total

    def start(self, now: float) -> list[Outgoing]:
        """Request the list anew."""
        self._reset(now)
        self.active = True
        return self._request_list(now)

    def resume(self, now: float) -> None:
        """Request only what is missing of a list that has ended incomplete."""
        self.active, self.problem, self._filling = True, None, True
        self._tries, self._lists, self._due = 0, MAX_LISTS, now
        self._asked.clear()

    @property
    def missing(self) -> tuple[int, ...]:
        """Indexes that have not arrived although the list has ended."""
        if self.active or self.total is None or self.complete:
            return ()
        return tuple(index for index in range(self.total) if index not in self.received)

    def stop(self) -> None:
        """End the list as it is."""
        self.active = False

    def finish(self, total: int) -> None:
        """Count all `total` parameters as received, from another source."""
        self.active, self.total, self.problem, self.received = False, total, None, set(range(total))

    def forget(self) -> None:
        """Forget the list that has ended."""
        self._reset(0.0)
        self.active = False

    def handle_value(self, index: int, total: int, now: float) -> None:
        """Count a parameter that has arrived. An index beyond `total` is not one of the list."""
        if not self.active or index >= total:
            return
        if total != self.total and not self._change_total(total):
            return
        self._requested.discard(index)
        if index not in self.received:
            self.received.add(index)
            self._tries = 0
            self._due = now if self._filling and not self._requested else now + LIST_TIMEOUT
        self.active = not self.complete

    def tick(self, now: float) -> list[Outgoing]:
        """Return the requests that are due: the list again, or some of its gaps."""
        if not self.active or now < self._due:
            return []
        if self._tries >= TRIES:
            self._fail(f"no list after {TRIES} tries" if self.total is None else self._gaps_text(self.total))
            return []
        missing = 0 if self.total is None else self.total - len(self.received)
        if self.total is None or (missing > LIST_AGAIN and self._lists < MAX_LISTS):
            return self._request_list(now)
        return self._request_gaps(self.total, now)

    def _reset(self, now: float) -> None:
        self.total = self.problem = None
        self.received.clear()
        self._tries = self._lists = self._changes = 0
        self._due = now
        self._filling = False
        self._requested: set[int] = set()
        """Gaps of the last request that have not arrived."""
        self._asked: Counter[int] = Counter()

    def _change_total(self, total: int) -> bool:
        """Begin anew with another count: the indexes may have moved. Return False if that never ends."""
        if self.total is not None:
            self._changes += 1
            if self._changes > MAX_COUNT_CHANGES:
                self._fail("the number of parameters keeps changing")
                return False
            self._filling, self._lists = False, 0
        self.total = total
        self.received.clear()
        self._requested.clear()
        self._asked.clear()
        return True

    def _request_list(self, now: float) -> list[Outgoing]:
        self._tries += 1
        self._lists += self.total is not None
        self._due = now + LIST_TIMEOUT
        return [Outgoing(m.ParamRequestList(*self._target))]

    def _request_gaps(self, total: int, now: float) -> list[Outgoing]:
        """Request the gaps that were requested least often, so that one without an answer delays no other."""
        self._tries += 1
        self._due, self._filling = now + GAP_TIMEOUT, True
        missing = (index for index in range(total) if index not in self.received)
        chosen = heapq.nsmallest(WINDOW, missing, key=lambda index: (self._asked[index], index))
        self._asked.update(chosen)
        self._requested = set(chosen)
        return [Outgoing(m.ParamRequestRead(*self._target, b"", index)) for index in chosen]

    def _gaps_text(self, total: int) -> str:
        missing = total - len(self.received)
        return f"{missing} of {total} parameters missing after {TRIES} tries"

    def _fail(self, problem: str) -> None:
        self.active, self.problem = False, problem
