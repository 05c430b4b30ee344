"""Texts that answer one ground station, mostly refusals: sent to it and to no other, with a budget for each.

Such a text is cheap to provoke, e.g. by a PARAM_SET of an unknown name. So these texts share no queue, no rate and no
log budget with what the vehicle reports about itself (vehicle/statustext.py), and each costs the same at any rate.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Protocol

import msgspec

from dialects.enums import Severity
from link.core import Peer
from link.protocol.rate import TokenBucket
from vehicle.repeats import RepeatFilter

RATE, BURST = 2.0, 12.0
"""STATUSTEXT messages/s to one ground station, and at once: PreArm may report ten reasons together."""
ASKERS_MAX = 32
"""Ground stations with a budget of their own; the one whose last text is oldest is forgotten first."""
QUEUE_SIZE = 100
"""Texts that may wait for the end of a control cycle; further ones are dropped."""
LOG_RATE, LOG_BURST = 1.0, 30.0
"""Texts/s that are logged, and at once, of all ground stations together: below 10 MB a day."""
ASKER_TEXTS = 8
"""Texts to one ground station that are remembered to find repeats."""


class Requester(Protocol):
    """The sender of a message or a command: `link.core.Received` and `CommandRequest` are two."""

    @property
    def peer(self) -> Peer:
        """The address that the reply goes to."""

    @property
    def system(self) -> int:
        """System id of the sender."""

    @property
    def may_ask(self) -> bool:
        """Whether the reply may be longer than the request."""


class _Budget(msgspec.Struct):
    """What one ground station has been sent."""

    bucket: TokenBucket = msgspec.field(default_factory=lambda: TokenBucket(RATE, BURST))
    repeats: RepeatFilter = msgspec.field(default_factory=lambda: RepeatFilter(ASKER_TEXTS))


class ReplyQueue:
    """Queues texts, each for one ground station."""

    def __init__(self, on_text: Callable[[Severity, str], None]) -> None:
        """`on_text` is called with each text that the log has room for."""
        self._on_text = on_text
        self._log_bucket = TokenBucket(LOG_RATE, LOG_BURST)
        self._budgets: dict[Peer, _Budget] = {}
        self._waiting: list[tuple[Peer, Severity, str]] = []

    def add(self, asker: Requester, severity: Severity, text: str, cost: int, now: float) -> None:
        """Queue a text of `cost` messages, unless it is a repeat or the budget of its asker is used up.

        To an asker without HEARTBEAT nothing is sent: its address may be another's.
        """
        budget = self._budget(asker.peer)
        if budget.repeats.is_repeat(text, now):
            return
        if self._log_bucket.consume(now):
            self._on_text(severity, text)
        if asker.may_ask and len(self._waiting) < QUEUE_SIZE and budget.bucket.consume(now, cost):
            self._waiting.append((asker.peer, severity, text))

    def pop(self) -> list[tuple[Peer, Severity, str]]:
        """Return the texts to send now and forget them."""
        waiting, self._waiting = self._waiting, []
        return waiting

    def _budget(self, peer: Peer) -> _Budget:
        budget = self._budgets.pop(peer, None) or _Budget()
        self._budgets[peer] = budget
        if len(self._budgets) > ASKERS_MAX:
            del self._budgets[next(iter(self._budgets))]
        return budget
