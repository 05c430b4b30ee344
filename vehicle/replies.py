"""Questions that one message answers at once: time, ping, and "nothing here" for plans.

Silence would cost the asker its repeats: QGroundControl waits for a list of missions before it shows the vehicle.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from dialects import messages as m
from link.core import Outgoing, Received
from link.services import timesync


class Replies:
    """Answers for one system and component."""

    def __init__(self, system: int, component: int) -> None:
        self._ids = (system, component)

    def answer(self, received: Received, now: float) -> list[Outgoing]:
        """The answer, or nothing where the message asks nothing of us."""
        found = _ANSWERS.get(type(received.message))
        if found is None:
            return timesync.answer(received, now, self._ids[0])
        return [Outgoing(found(received), received.peer)] if self._for_us(received.message) else []

    def _for_us(self, message: Any) -> bool:
        return message.target_system == self._ids[0] and message.target_component in (0, self._ids[1])


def _no_mission(received: Received) -> m.Message:
    asked: Any = received.message
    return m.MissionCount(received.system, received.component, 0, mission_type=asked.mission_type)


_ANSWERS: dict[type[m.Message], Callable[[Received], m.Message]] = {
    m.MissionRequestList: _no_mission,
}
"""Message -> answer. Missions are not offered yet."""
