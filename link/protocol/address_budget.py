"""Address budget: bytes for an address that has not shown that it receives what is sent to it.

The address on a datagram can be forged: who writes that of a third party on a HEARTBEAT has our telemetry sent there.
MAVProxy and scripts answer nothing that we could ask, so that telemetry cannot wait for an answer. An address that has
not answered gets a multiple of what came from it, and no more; urgent messages, as HEARTBEAT and COMMAND_ACK, always.
"""

from __future__ import annotations

import secrets
from collections.abc import Iterator

from dialects.messages import Heartbeat, Message, Ping, Timesync
from dialects.traits import URGENT

FACTOR = 100
"""Bytes for each that came. Default telemetry is 53 times a HEARTBEAT a second, all that some stations send."""
FIRST_REQUEST = 8192
"""Bytes more for the first frame that is not a HEARTBEAT: a station asks for all parameters at once."""
LIMIT = 65536
"""Bytes that may be saved up."""
ASK_PERIOD, ASK_AGAIN, ASKS = 1.0, 10.0, 5
"""s between two questions, after ASKS of them longer."""


class AddressBudget:
    """What may still be sent to one address."""

    def __init__(self) -> None:
        self.proven = False
        """Something came that answers us: nothing is limited any more."""
        self._left = 0.0
        self._has_requested = False
        self._nonce = secrets.randbits(62)
        self._asks = 0
        self._due = 0.0

    def grant(self, message_id: int, size: int) -> None:
        """Count a frame of `size` bytes that came from the address."""
        more = FACTOR * size
        if message_id != Heartbeat.id and not self._has_requested:
            self._has_requested = True
            more += FIRST_REQUEST
        self._left = min(LIMIT, self._left + more)

    def take(self, message_id: int, size: int) -> bool:
        """Return whether a frame of `size` bytes may be sent, and count it."""
        if self.proven or message_id in URGENT:
            return True
        if size > self._left:
            return False
        self._left -= size
        return True

    def questions(self, now: float) -> Iterator[Message]:
        """Yield what to ask now: PING, which ground stations answer, and TIMESYNC, which autopilots answer."""
        if self.proven or now < self._due:
            return
        self._asks += 1
        self._due = now + (ASK_PERIOD if self._asks < ASKS else ASK_AGAIN)
        yield Ping(self._nonce, self._asks, 0, 0)
        yield Timesync(0, self._nonce)

    def note_answer(self, message: Message) -> None:
        """Handle a possible answer: it holds a number that nobody can guess."""
        if isinstance(message, Timesync):
            self.proven |= message.tc1 != 0 and message.ts1 == self._nonce
        elif isinstance(message, Ping):
            self.proven |= message.target_system != 0 and message.time_usec == self._nonce
