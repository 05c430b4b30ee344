"""The lesson of a screen that `mavhelm learn` starts in another process: a replay, or a tab of a browser."""

from __future__ import annotations

import argparse
import threading
from collections.abc import Callable
from typing import TYPE_CHECKING

from groundstation.cli.local.runner import UsageError

if TYPE_CHECKING:
    from groundstation.learn.course import CourseLesson
    from groundstation.ui.learn.lesson_dock import LessonDock

LESSON, STEP = "--lesson", "--lesson-step"
"""Options of `mavhelm replay` and `mavhelm attach`, which `mavhelm learn` gives them: lesson, and first step."""


def add_lesson(parser: argparse.ArgumentParser) -> None:
    """Add the options. --help does not show them, because `mavhelm learn` is how to begin a lesson."""
    parser.add_argument(LESSON, metavar="LESSON", help=argparse.SUPPRESS)
    parser.add_argument(STEP, type=int, default=0, metavar="N", help=argparse.SUPPRESS)


def lesson_words(lesson: CourseLesson, step: int) -> list[str]:
    """Return these options for a lesson."""
    return [f"{LESSON}={lesson.id}", f"{STEP}={step}"]


def find_lesson(name: str) -> CourseLesson:
    """Return a lesson by its number, or by the path of its file. Raises UsageError."""
    from pathlib import Path

    from groundstation.learn.course import load_course, load_own
    from groundstation.learn.lesson_file import LessonError

    try:
        if not name.isdecimal():
            if name.isalpha() and not Path(name).exists():
                raise UsageError(f"{name!r} is neither a lesson file nor a number: `mavhelm learn list` shows them")
            return load_own(Path(name))
        course = load_course()
    except LessonError as error:
        raise UsageError(str(error)) from error
    found = next((each for each in course if each.id == str(int(name))), None)
    if found is None:
        raise UsageError(f"there is no lesson {name}: `mavhelm learn list` shows 1 to {len(course)}")
    return found


def continue_lesson(options: argparse.Namespace) -> LessonDock | None:
    """Return the lesson that the options name, from its step on; None without one. Raises UsageError."""
    return None if options.lesson is None else open_lesson(find_lesson(options.lesson), options.lesson_step)


def open_lesson(lesson: CourseLesson, step: int = 0, next_heading: str = "") -> LessonDock:
    """Return a lesson for a screen. What is done is saved at once."""
    from groundstation.learn.attempt import Attempt
    from groundstation.learn.progress import Progress
    from groundstation.ui.learn.lesson_dock import LessonDock

    before = Progress().stamp  # a replay that writes the progress has done the lesson: it does nothing else there

    return LessonDock(
        f"Lesson {lesson.id}" if lesson.id.isdecimal() else "Lesson",
        Attempt(lesson.lesson, min(step, len(lesson.lesson.steps))),
        done=_saver(lesson.id),
        next_heading=next_heading,
        replay_words=lambda attempt: lesson_words(lesson, attempt.step),
        done_in_replay=lambda: Progress().stamp != before,
    )


def _saver(lesson: str) -> Callable[[], object]:
    """Return what saves the progress: in a thread, because a slow disk must not keep a screen from its lease."""
    from groundstation.learn.progress import Progress

    return lambda: threading.Thread(target=lambda: Progress().add(lesson), name="learn").start()
