"""Which path questions take: the best one, and the next one when it brings no answer.

Questions are commands, and requests for parameters, plans, files and logs. Who asks repeats; this only says where.
"""

from __future__ import annotations

import math

from dialects import messages as m
from dialects.enums import Result
from dialects.traits import ACKED
from groundstation.vehicles.paths.copies import TOLD
from groundstation.vehicles.paths.path import LATE, Path

PATIENCE = 0.3
"""s without an answer after which the next question takes the next path: all who ask repeat later than this."""
RETURN_AFTER = 2.0
"""s without a question after which the next one takes the best path again."""
_NO_ANSWERS: tuple[type[m.Message], ...] = (*TOLD, m.Timesync, m.Ping)
ANSWERS = frozenset(ACKED - {int(each.id) for each in _NO_ANSWERS})
"""Ids of messages that answer a question."""


class Questions:
    """The path of the questions to one vehicle."""

    def __init__(self) -> None:
        self._path: Path | None = None
        self._waits_since: float | None = None
        """When the first question was sent that has no answer; None: none waits."""
        self._asked_at = -math.inf

    def choose(self, live: list[Path], now: float) -> Path:
        """Return the path of a question that is sent now. `live`: the paths that are heard, the best one first.

        A late path gets none while there is another one: our vehicle takes no command from it.
        """
        live = [each for each in live if each.lag <= LATE] or live
        path = self._path
        if path is None or path not in live or (now - self._asked_at > RETURN_AFTER):
            path, self._waits_since = live[0], None
        elif self._waits_since is not None and now - self._waits_since >= PATIENCE:
            path, self._waits_since = live[(live.index(path) + 1) % len(live)], None
        self._path, self._asked_at = path, now
        if self._waits_since is None:
            self._waits_since = now
        return path

    def note_answer(self, message: m.Message) -> None:
        """Note an answer of the vehicle. That it takes the command later, perhaps over another path, is none."""
        if not (isinstance(message, m.CommandAck) and message.result == Result.TEMPORARILY_REJECTED):
            self._waits_since = None
