"""LessonDock: an attempt at a lesson beside the screens. It listens, turns pages, and never sends anything."""

from __future__ import annotations

from collections.abc import Callable

from groundstation.input.keymap import Keymap
from groundstation.learn.attempt import Attempt
from groundstation.learn.lesson import print_keys
from groundstation.snapshot import Snapshot
from groundstation.ui.keys.keynames import format_key, main_key
from groundstation.ui.learn.layout import BELOW_FROM, HEIGHT, WIDTH, PanePlace, Size, choose_place, room_beside
from groundstation.ui.learn.pane import (
    DONE,
    DUE,
    LATER,
    WRONG,
    LessonPane,
    LessonPaneValue,
    TaskLine,
    find_page,
    lay_out,
)
from groundstation.views.base import View

AT_TASK = -1
"""Page: the one with the task that is due."""
ACTION = "view.lesson"
ARMED_STILL = "disarm first: the next lesson starts with other simulators"


class LessonDock:
    """What the app and its screens know of the lesson."""

    def __init__(
        self,
        name: str,
        attempt: Attempt,
        *,
        done: Callable[[], object] = lambda: None,
        next_heading: str = "",
        replay_words: Callable[[Attempt], list[str]] = lambda attempt: [],
        done_in_replay: Callable[[], bool] = lambda: False,
    ) -> None:
        """Begin. `done` is called once all steps are done. `next_heading`: of the lesson after it; "" for none.

        `replay_words`: options of `mavhelm replay`, which shows the same lesson beside a log. `done_in_replay` returns
        whether it was done there.
        """
        self._name, self.attempt = name, attempt
        self._done, self._next, self._replay_words = done, next_heading, replay_words
        self._done_in_replay = done_in_replay
        self._hidden = False
        self._page = 0
        self._seen = (attempt.step, attempt.hint)
        self.goes_on = False
        """The pupil has asked for the next lesson."""

    # ---- what is seen ----

    def see(self, now: Snapshot, screen: str) -> None:
        """Take a snapshot."""
        self.attempt.see(now, screen)
        self._follow()

    def see_view(self, view: View) -> None:
        """Take a view."""
        self.attempt.see_view(view)
        self._follow()

    def come_back(self) -> None:
        """Take note that a replay has ended, and that the last steps may have been done beside it."""
        if not self.attempt.done and self._done_in_replay():
            self.attempt.step = len(self.attempt.lesson.steps)
            self._follow()

    def _follow(self) -> None:
        """Show the task when there is something new about it."""
        seen = (self.attempt.step, self.attempt.hint)
        if seen == self._seen:
            return
        self._seen, self._hidden, self._page = seen, False, AT_TASK
        if self.attempt.done:
            self._done()

    @property
    def replay_options(self) -> list[str]:
        """Options of a replay that is opened now."""
        return [] if self.attempt.done else self._replay_words(self.attempt)

    # ---- what is shown ----

    def turn_page(self, size: Size, keymap: Keymap) -> None:
        """Show the next page; after the last one hide the pane, or go on when all is done."""
        value = self.value(size, keymap)
        if self._hidden or value.place is PanePlace.HIDDEN:
            self._hidden, self._page = False, 0
            return
        pages = lay_out(value, *_pane_size(size))
        at = find_page(value, pages)
        if at + 1 < len(pages):
            self._page = at + 1
        elif self.attempt.done and self._next:
            self.goes_on = True
        else:
            self._hidden = True

    def place(self, size: Size) -> PanePlace:
        """Return where the pane is in a terminal of this size."""
        return PanePlace.HIDDEN if self._hidden else choose_place(size)

    def find_hidden(self, size: Size) -> str:
        """Return what to do where the terminal is too small for the pane; "" where it is shown, or hidden by a key."""
        too_small = not self._hidden and choose_place(size) is PanePlace.HIDDEN
        return (
            f"the lesson needs {BELOW_FROM[0]}x{BELOW_FROM[1]} characters: make the window larger" if too_small else ""
        )

    def room(self, size: Size) -> Size:
        """Return what is left to the screen."""
        return room_beside(size, self.place(size))

    def build(self, size: Size, keymap: Keymap) -> LessonPane:
        """Return a pane for a screen."""
        return LessonPane(self.value(size, keymap), id="lesson")

    def value(self, size: Size, keymap: Keymap) -> LessonPaneValue:
        """Return what the pane shows."""
        lesson, key = self.attempt.lesson, _key_of(keymap)

        def show(text: str) -> str:
            return " ".join(print_keys(text, key).split())

        end = tuple(show(line) for line in lesson.why) if self.attempt.done else ()
        if end:
            goes = (
                f"[{key(ACTION)}] goes on with lesson {self._next}."
                if self._next
                else f"[{key('app.quit')}] ends this screen."
            )
            end = ("DONE. Why this matters:", *end, goes)
        step = min(self.attempt.step + 1, len(lesson.steps))
        state = "done" if self.attempt.done else f"task {step} of {len(lesson.steps)}"
        return LessonPaneValue(
            heading=f"{self._name} · {state} · {lesson.title}",
            place=self.place(size),
            text=tuple(show(each) for each in lesson.text.split("\n\n")),
            code=tuple(lesson.code.strip("\n").split("\n")) if lesson.code else (),
            tasks=self._tasks(show),
            end=end,
            page=self._page,
            key=key(ACTION),
        )

    def _tasks(self, show: Callable[[str], str]) -> tuple[TaskLine, ...]:
        found = []
        for at, step in enumerate(self.attempt.lesson.steps):
            mark = DONE if at < self.attempt.step else DUE if at == self.attempt.step else LATER
            found.append(TaskLine(mark, show(step.task)))
            if mark == DUE and self.attempt.hint:
                found.append(TaskLine(WRONG, show(self.attempt.hint)))
        return tuple(found)


def _pane_size(size: Size) -> Size:
    return (WIDTH, size[1]) if choose_place(size) is PanePlace.RIGHT else (size[0], HEIGHT)


def _key_of(keymap: Keymap) -> Callable[[str], str]:
    def find(action: str) -> str:
        key = main_key(keymap, action)
        return "?" if key is None else format_key(key)

    return find
