"""`mavhelm learn`: lessons on the real screens, with simulated rovers."""

from __future__ import annotations

import argparse
import shutil
import sys
from collections.abc import Sequence
from pathlib import Path

from groundstation.cli.console import import_screen, open_screen, record_options, terminal_path
from groundstation.cli.local.lesson_options import find_lesson, lesson_words, open_lesson
from groundstation.cli.local.runner import UsageError, load_settings, run_local
from groundstation.cli.options import add_config, add_port, add_settings
from groundstation.cli.verb_help import local_examples
from groundstation.client import StationClient
from groundstation.config.settings import Settings
from groundstation.learn.course import CourseLesson, load_course
from groundstation.learn.lesson_file import LessonError
from groundstation.learn.progress import Progress
from groundstation.learn.requirements import find_missing
from link.runtime.command_line import CommandLineParser

LIST, RESET = "list", "reset"
"""Words in place of a lesson."""
LEAST_TERMINAL = (80, 24)
"""Columns and rows: a smaller one has no room for the pane."""

SETTINGS = ("keymap", "theme", "ascii", "reduce_motion", "style", "gamepad", "folder", "log_file")
"""Settings that mean something in a lesson."""

EPILOG = """\
Each lesson starts simulated rovers of its own and checks what they do. The pane beside the screens has its text, the
task that is due, and a hint after a mistake. Ctrl-L turns its page, hides and shows it. What is done is saved.

A lesson of your own is a TOML file; docs/teach.md has its keys.

exit codes: 0 after a session, 2 for wrong arguments or a lesson file that cannot be used, 128 + n after signal n
"""


def build_parser() -> CommandLineParser:
    """Return the parser."""
    parser = CommandLineParser(
        prog="mavhelm learn",
        description="Learn to drive, and what MAVLink is, in ten lessons with simulated rovers.",
        epilog=f"{local_examples('learn')}\n\n{EPILOG}",
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument(
        "lesson",
        nargs="?",
        metavar="LESSON",
        help=f"number of a lesson, or a TOML file; {LIST}: all lessons; {RESET}: forget what is done; "
        "without it the first that is not done",
    )
    parser.add_argument("--web", action="store_true", help="in browsers of this machine; docs/browser.md")
    add_port(parser)
    add_settings(parser, SETTINGS)
    add_config(parser)
    return parser


def run(arguments: Sequence[str]) -> int:
    """Run `mavhelm learn`; return the exit code."""
    return run_local(build_parser(), arguments, _learn)


def _learn(options: argparse.Namespace) -> int:
    if options.lesson == RESET:
        return _reset()
    if options.lesson == LIST:
        return _list()
    settings = load_settings(options).settings
    chosen = _choose(options.lesson)
    if options.web:
        return _serve(settings, chosen, options.port)
    lesson: CourseLesson | None = chosen
    code = 0
    while lesson is not None:
        code, lesson = _teach(settings, lesson)
    return code


def _choose(name: str | None) -> CourseLesson:
    """Return the lesson of this name, or the first one that is not done. Raises UsageError."""
    if name is not None:
        found = find_lesson(name)
        if missing := find_missing(found.lesson.requires):
            raise UsageError(f"lesson {found.heading} cannot be done here: {missing}")
        return found
    progress = Progress()
    if progress.warning:
        print(f"mavhelm: {progress.warning}", file=sys.stderr)
    course = _possible()
    return next((each for each in course if each.id not in progress.done), course[0])


def _possible() -> list[CourseLesson]:
    """Return the lessons that can be done here. Raises UsageError."""
    return [each for each in _course() if not find_missing(each.lesson.requires)]


def _course() -> Sequence[CourseLesson]:
    try:
        return load_course()
    except LessonError as error:
        raise UsageError(str(error)) from error


def _next(lesson: CourseLesson) -> CourseLesson | None:
    """Return the lesson after one of the course."""
    if not lesson.id.isdecimal():
        return None
    return next((each for each in _possible() if int(each.id) > int(lesson.id)), None)


def _teach(settings: Settings, lesson: CourseLesson) -> tuple[int, CourseLesson | None]:
    """Run one lesson to its end; return the exit code, and the next lesson if the pupil goes on."""
    columns, rows = shutil.get_terminal_size()
    if columns < LEAST_TERMINAL[0] or rows < LEAST_TERMINAL[1]:
        raise UsageError(f"the terminal is {columns}x{rows}: a lesson needs {LEAST_TERMINAL[0]}x{LEAST_TERMINAL[1]}")
    after = _next(lesson)
    import_screen()
    dock = open_lesson(lesson, next_heading="" if after is None else after.heading)
    rovers = [each.options for each in lesson.lesson.simulators]

    def connect(log_file: Path | None) -> StationClient:
        return StationClient.start(
            [],
            style=settings.style,
            speed=settings.speed,
            take_off=settings.take_off,
            sitl=True,
            simulators=rovers,
            log_file=log_file,
            record=record_options(settings, log_file),
            terminal=terminal_path(),
            meanwhile=import_screen,
        )

    code = open_screen(settings, connect, lesson.lesson.screen, lesson=dock)
    return code, after if dock.goes_on else None


def _serve(settings: Settings, lesson: CourseLesson, port: int) -> int:
    """Serve a lesson; its first tab drives, because the lesson does not say how to take the keys."""
    from groundstation.cli.local.serve import serve

    rovers = [each.options for each in lesson.lesson.simulators]
    tabs = lesson_words(lesson, 0)
    return serve(settings, [], sitl=True, simulators=rovers, port=port, tab_options=tabs)


def _list() -> int:
    done = Progress().done
    for each in _course():
        missing = find_missing(each.lesson.requires)
        mark = "done" if each.id in done else "skipped" if missing else "-"
        why = f"  ({missing})" if mark == "skipped" else ""
        print(f"{each.id:>2}  {mark:<8}{each.lesson.title}{why}")
    return 0


def _reset() -> int:
    progress = Progress()
    progress.reset()
    if progress.warning:
        raise UsageError(progress.warning)
    print("no lesson is done any more", file=sys.stderr)
    return 0
