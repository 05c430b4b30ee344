"""MISSION_ITEM_REACHED: said when an item is done, and a few times more.

Nobody answers it, and MAVSDK knows only by it that a mission is finished: lost once, a script would wait for ever.
"""

from __future__ import annotations

from collections.abc import Sequence

from dialects import messages as m
from link.core import Outgoing

SEND_COUNT, SEND_PERIOD = 4, 0.5
"""How often it is said, and s between."""


class ItemReachedSender:
    """The newest item that was done; older ones are not said again."""

    def __init__(self) -> None:
        self._index = 0
        self._left = 0
        self._due = 0.0

    def tick(self, done: Sequence[int], now: float) -> list[Outgoing]:
        """What to say: each of `done`, the items done since the last call, and the newest again where it is time."""
        said = [Outgoing(m.MissionItemReached(index)) for index in done]
        if done:
            self._index, self._left, self._due = done[-1], SEND_COUNT - 1, now + SEND_PERIOD
        elif self._left and now >= self._due:
            said.append(Outgoing(m.MissionItemReached(self._index)))
            self._left, self._due = self._left - 1, now + SEND_PERIOD
        return said

    def reset(self) -> None:
        """Another mission, or another item of it: what was done before is of no interest."""
        self._left = 0
