"""The question before the emergency stop of a vehicle in the air: without power it falls. Time is an argument."""

from __future__ import annotations

CONFIRM_AFTER = 1.0
"""s without a press before the next one counts as the answer: longer than the delay with which a held key begins to
repeat, so that holding the key asks and never answers."""

CONFIRM_WITHIN = 5.0
"""s in which the answer must come; after that a press asks again."""

FALLS = f"is in the air and falls without power: press the emergency stop again after {CONFIRM_AFTER:g} s to cut it"
"""Completes the name of the vehicle."""


class StopQuestions:
    """The questions that wait for their answer, by system id."""

    def __init__(self) -> None:
        self._asked: dict[int, float] = {}
        """System id -> when the emergency stop was pressed last."""

    def confirms(self, system: int, now: float) -> bool:
        """Handle a press; return whether it answers the question of an earlier one."""
        before = self._asked.get(system)
        self._asked[system] = now
        return before is not None and CONFIRM_AFTER <= now - before <= CONFIRM_WITHIN

    def forget(self, system: int) -> None:
        """Forget a question: the stop is sent."""
        self._asked.pop(system, None)

    def left(self, system: int, now: float) -> float | None:
        """Return the s left to answer; None without a question."""
        asked = self._asked.get(system)
        return None if asked is None or now - asked > CONFIRM_WITHIN else CONFIRM_WITHIN - (now - asked)
