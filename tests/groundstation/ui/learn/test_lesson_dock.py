"""The pane of a lesson: its place, its pages, and what Ctrl-L does with them."""

from __future__ import annotations

import re
from itertools import takewhile

from msgspec.structs import replace

from groundstation.input.keymap import KEYMAPS, Keymap
from groundstation.learn.attempt import Attempt
from groundstation.learn.course import load_course
from groundstation.ui.learn.layout import PanePlace
from groundstation.ui.learn.lesson_dock import AT_TASK, LessonDock
from groundstation.ui.learn.pane import DUE, WRONG, find_page, lay_out

KEYS = Keymap("standard", KEYMAPS["standard"])
SMALL, LARGE = (80, 24), (140, 45)
MOST_PAGES = 6


def dock(number: int, done: list[int] | None = None, after: str = "2 Next") -> LessonDock:
    note = (lambda: done.append(number)) if done is not None else lambda: None
    return LessonDock(f"Lesson {number}", Attempt(load_course()[number - 1].lesson), done=note, next_heading=after)


def test_the_pane_leaves_room_for_the_screen() -> None:
    pane = dock(1)
    assert [pane.place(size) for size in (LARGE, SMALL, (79, 24))] == [
        PanePlace.RIGHT,
        PanePlace.BELOW,
        PanePlace.HIDDEN,
    ]
    assert [bool(pane.find_hidden(size)) for size in (LARGE, SMALL, (79, 24))] == [False, False, True]
    assert [pane.room(size) for size in (LARGE, SMALL, (79, 24))] == [(100, 45), (80, 18), (79, 24)]


def test_every_lesson_fits_into_its_pages() -> None:
    for number in range(1, 11):
        value = dock(number).value(SMALL, KEYS)
        pages = lay_out(value, 80, 6)
        assert len(pages) <= MOST_PAGES
        assert all(len(page) <= 5 and all(len(text) <= 78 for _, text in page) for page in pages)
        assert "?" not in "".join(task.text for task in value.tasks).replace("stand?", "").replace("now?", "")
        if number not in (9, 10):  # their code has a page of its own there
            assert len(lay_out(dock(number).value(LARGE, KEYS), 40, 45)) == 1


def test_each_task_is_whole_and_the_same_in_every_size() -> None:
    for number in range(1, 11):
        pane = dock(number)
        for step, due in enumerate(pane.attempt.lesson.steps):
            pane.attempt.step = step
            for size in (SMALL, (82, 25), (120, 30), LARGE):
                value = replace(pane.value(size, KEYS), page=AT_TASK)
                pages = lay_out(value, *((40, size[1]) if pane.place(size) is PanePlace.RIGHT else (size[0], 6)))
                shown = iter(pages[find_page(value, pages)])
                first = next(text for mark, text in shown if mark == DUE)
                rest = [text for _, text in takewhile(lambda line: line[0] == " ", shown)]
                keys = re.split(r"`[^`]+`", due.task)
                said = re.split(r"\[[^\[\]]+\]|\[\[\]|\[\]\]", " ".join([first, *rest]))
                assert said == keys, (number, step, size)


def test_the_key_turns_pages_then_hides_then_shows() -> None:
    pane = dock(1)
    for _ in range(len(lay_out(pane.value(SMALL, KEYS), 80, 6))):
        assert pane.place(SMALL) is PanePlace.BELOW
        pane.turn_page(SMALL, KEYS)
    assert pane.room(SMALL) == SMALL
    pane.turn_page(SMALL, KEYS)
    assert (pane.place(SMALL), pane.value(SMALL, KEYS).page) == (PanePlace.BELOW, 0)


def test_a_hint_shows_the_pane_again_and_the_end_goes_on_once() -> None:
    done: list[int] = []
    pane = dock(1, done)
    pane.turn_page(LARGE, KEYS)
    assert pane.place(LARGE) is PanePlace.HIDDEN
    pane.attempt.hint = "Hold `drive.forward`."
    pane._follow()
    marks = {task.mark: task.text for task in pane.value(LARGE, KEYS).tasks}
    assert pane.place(LARGE) is PanePlace.RIGHT
    assert (marks[WRONG], marks[DUE][:8]) == ("Hold [i].", "Hold [r]")
    pane.attempt.step = len(pane.attempt.lesson.steps)
    pane._follow()
    pane._follow()
    assert done == [1]
    value = pane.value(SMALL, KEYS)
    pages = lay_out(value, 80, 6)
    assert pages[find_page(value, pages)][0] == ("", "DONE. Why this matters:")
    pane.turn_page(LARGE, KEYS)
    assert pane.goes_on
