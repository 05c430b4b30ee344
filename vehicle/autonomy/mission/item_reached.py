"""Sends MISSION_ITEM_REACHED when an item is done, and repeats it a few times.

The message is not acknowledged, and MAVSDK detects the end of a mission only by it: if it were lost, a script would
wait forever.
"""

from __future__ import annotations

from collections.abc import Sequence

from dialects import messages as m
from link.core import Outgoing

SEND_COUNT, SEND_PERIOD = 4, 0.5
"""Number of transmissions, and s between them."""


class ItemReachedSender:
    """Repeats the message of the newest item; older ones are not repeated."""

    def __init__(self) -> None:
        self._index = 0
        self._left = 0
        self._due = 0.0

    def tick(self, done: Sequence[int], now: float) -> list[Outgoing]:
        """Return the messages due: one for each item of `done`, reached since the last call, and repetitions."""
        messages = [Outgoing(m.MissionItemReached(index)) for index in done]
        if done:
            self._index, self._left, self._due = done[-1], SEND_COUNT - 1, now + SEND_PERIOD
        elif self._left and now >= self._due:
            messages.append(Outgoing(m.MissionItemReached(self._index)))
            self._left, self._due = self._left - 1, now + SEND_PERIOD
        return messages

    def reset(self) -> None:
        """Stop repeating: another mission or another item was chosen."""
        self._left = 0
