"""Attempt: one pupil at one lesson: which step is due, what was seen of it, which hint fits, and whether it is done."""

from __future__ import annotations

from groundstation.learn.conditions import is_done
from groundstation.learn.deeds import Deeds
from groundstation.learn.lesson import Lesson, Step
from groundstation.snapshot import Snapshot
from groundstation.views.base import View


class Attempt:
    """Follows what the rover does. It sends nothing, and knows no key."""

    def __init__(self, lesson: Lesson, step: int = 0) -> None:
        self.lesson = lesson
        self.step = step
        """Index of the step that is due; the number of steps when all are done."""
        self.hint = ""
        """What is said about the newest wrong deed; "" for none."""
        self.deeds = Deeds()
        self._hint_deeds: list[Deeds] = []
        """For each hint of the step, what was seen since another one was shown, so that the newest deed counts."""
        self._held: list[bool] = []
        """Which hints held at the newest look."""
        self._begin_hints()

    @property
    def done(self) -> bool:
        """All steps are done."""
        return self.step >= len(self.lesson.steps)

    @property
    def due(self) -> Step | None:
        """The step that is due."""
        return None if self.done else self.lesson.steps[self.step]

    def see(self, now: Snapshot, screen: str) -> None:
        """Take a snapshot, shown on the screen of this id."""
        if not self.done:
            for deeds in (self.deeds, *self._hint_deeds):
                deeds.see(now, screen)
            self._judge()

    def see_view(self, view: View) -> None:
        """Take a view of the screen."""
        if not self.done:
            for deeds in (self.deeds, *self._hint_deeds):
                deeds.see_view(view)
            self._judge()

    def _judge(self) -> None:
        due = self.due
        if due is None:
            return
        if is_done(self.deeds, due):
            self.step += 1
            self.hint = ""
            self.deeds = Deeds()  # what was done before does not count for the next step
            self._begin_hints()
            return
        before, self._held = self._held, [is_done(*each) for each in zip(self._hint_deeds, due.hints, strict=True)]
        newest = next((at for at, held in enumerate(self._held) if held and not before[at]), None)
        if newest is not None:
            self.hint = due.hints[newest].text
            self._hint_deeds = [each if at == newest else Deeds() for at, each in enumerate(self._hint_deeds)]

    def _begin_hints(self) -> None:
        hints = () if self.due is None else self.due.hints
        self._hint_deeds = [Deeds() for _ in hints]
        self._held = [False for _ in hints]
