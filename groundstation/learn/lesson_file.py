"""Reads lesson files. Every mistake is one line that names the file, the line in it, and what to do."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from pathlib import Path

import msgspec

from groundstation.actions import ACTIONS
from groundstation.learn.conditions import CONDITIONS
from groundstation.learn.lesson import (
    CODE_SIZE,
    KEY,
    MOST_TASK_WORDS,
    MOST_WORDS,
    WHY_LINES,
    Checked,
    Lesson,
    is_action,
)
from groundstation.learn.requirements import REQUIREMENTS
from groundstation.screens import SCREENS
from link.toml.errors import explain_error, suggest
from link.toml.file import TomlError, parse_toml, read_text

MAX_SIZE = 64 * 1024
"""Bytes of a file that is read; a lesson has 4 kB."""

_TABLE = re.compile(r"\s*\[\[?(?P<name>[\w.]+)\]\]?\s*(?:#.*)?$")
_STEP = re.compile(r"\.(\w+)(?:\[(\d+)\])?")
TABLES = ("steps", "hints", "simulators")
"""Keys that are tables of their own in the file: [[steps]], [[steps.hints]]."""


class LessonError(Exception):
    """A lesson file cannot be used; the text is one line: file, line, mistake, remedy."""


def load_lesson(path: Path) -> Lesson:
    """Return the lesson of a file. Raises LessonError."""
    try:
        text = read_text(path, MAX_SIZE)
        return parse_lesson(text, str(path))
    except TomlError as error:
        raise LessonError(str(error)) from error


def parse_lesson(text: str, name: str) -> Lesson:
    """Return the lesson of a text; `name` is that of its file. Raises LessonError."""
    try:
        table = parse_toml(text, name)
    except TomlError as error:
        raise LessonError(str(error)) from error
    try:
        lesson = msgspec.convert(table, Lesson)
    except msgspec.ValidationError as error:
        where = _place_of_error(error)
        line = explain_error(error, Lesson, "")
        raise LessonError(f"{name}:{_find_line(text, where)}: {line}") from error
    for place, mistake in _find_mistakes(lesson):
        raise LessonError(f"{name}:{_find_line(text, place)}: {_join(place)}: {mistake}")
    return lesson


TextPlace = Sequence[tuple[str, int]]
"""Keys from the top of the file on, each with its index in a list; 0 outside of one."""


def _place_of_error(error: msgspec.ValidationError) -> TextPlace:
    """Return where a mistake is, of msgspec's path: `$.steps[0].hints[1].value`."""
    what, _, path = str(error).partition(" - at `$")
    steps = [(name, int(index or 0)) for name, index in _STEP.findall(path)]
    named = re.fullmatch(r"Object (?:contains unknown|missing required) field `(.+)`", what.removesuffix("`") + "`")
    return [*steps, *([(named[1], 0)] if named else [])]


def _find_mistakes(lesson: Lesson) -> Iterator[tuple[TextPlace, str]]:
    """Yield what types cannot say: names that do not exist, texts that are too long."""
    yield from _check_top(lesson)
    for number, step in enumerate(lesson.steps):
        at = (("steps", number),)
        yield from _check_words(at, "task", step.task)
        yield from _check_condition(at, step)
        for index, hint in enumerate(step.hints):
            yield from _check_words((*at, ("hints", index)), "text", hint.text)
            yield from _check_condition((*at, ("hints", index)), hint)


def _check_top(lesson: Lesson) -> Iterator[tuple[TextPlace, str]]:
    words = len(lesson.text.split())
    if not 0 < words <= MOST_WORDS:
        yield (("text", 0),), f"has {words} words; write 1 to {MOST_WORDS}"
    code = lesson.code.strip("\n").split("\n")
    if len(code) > CODE_SIZE[1] or max(map(len, code)) > CODE_SIZE[0]:
        yield (("code", 0),), f"is larger than {CODE_SIZE[0]} columns and {CODE_SIZE[1]} lines"
    if len(lesson.why) != WHY_LINES:
        yield (("why", 0),), f"has {len(lesson.why)} lines; write {WHY_LINES}"
    screens = [row.id for row in SCREENS if row.in_tabs]
    if lesson.screen not in screens:
        yield (("screen", 0),), f"there is no screen {lesson.screen!r}; {suggest(lesson.screen, screens)}"
    unknown = (name for name in lesson.requires if name not in REQUIREMENTS)
    yield from (((("requires", 0),), f"{name!r} is not known; {suggest(name, REQUIREMENTS)}") for name in unknown)
    if not lesson.steps:
        yield (("steps", 0),), "has no step; write [[steps]] with a task and a check"
    yield from (((("text", 0),), each) for each in _unknown_keys(lesson.text))


def _check_words(at: TextPlace, key: str, text: str) -> Iterator[tuple[TextPlace, str]]:
    if not text.strip():
        yield (*at, (key, 0)), "is empty; say what to do"
    if len(text.split()) > MOST_TASK_WORDS:
        yield (*at, (key, 0)), f"has {len(text.split())} words; write at most {MOST_TASK_WORDS}"
    yield from (((*at, (key, 0)), each) for each in _unknown_keys(text))


def _unknown_keys(text: str) -> Iterator[str]:
    for key in KEY.findall(text):
        if is_action(key) and key not in ACTIONS:
            yield f"there is no action `{key}`; {suggest(key, ACTIONS)}"


def _check_condition(at: TextPlace, asked: Checked) -> Iterator[tuple[TextPlace, str]]:
    row = CONDITIONS.get(asked.check)
    if row is None:
        yield (*at, ("check", 0)), f"there is no check {asked.check!r}; {suggest(asked.check, CONDITIONS)}"
        return
    if row.named and not asked.name:
        yield (*at, ("check", 0)), f"{asked.check} needs name = the {row.named}"
    if asked.name and not row.named:
        yield (*at, ("name", 0)), f"{asked.check} takes no name; remove it"
    if row.unit and row.named == "" and asked.value <= 0:
        yield (*at, ("check", 0)), f"{asked.check} needs value = a number above 0, in {row.unit}"
    if asked.value and not row.unit:
        yield (*at, ("value", 0)), f"{asked.check} takes no value; remove it"
    screens = [screen.id for screen in SCREENS]
    if row.named == "screen" and asked.name and asked.name not in screens:
        yield (*at, ("name", 0)), f"there is no screen {asked.name!r}; {suggest(asked.name, screens)}"


def _join(place: TextPlace) -> str:
    return ".".join(f"{name}[{index}]" if name in TABLES else name for name, index in place)


def _find_line(text: str, place: TextPlace) -> int:
    """Return the line of a key, from 1; that of the table around it where it has none."""
    tables = [step for step in place if step[0] in TABLES]
    key = next((name for name, _ in place if name not in TABLES), "")
    start, here = 1, not tables
    count: dict[str, int] = {}
    for number, line in enumerate(text.splitlines(), 1):
        if table := _TABLE.match(line):
            name = table["name"]
            count = {each: at for each, at in count.items() if not each.startswith(f"{name}.")}
            count[name] = count.get(name, -1) + 1
            here = name == ".".join(each for each, _ in tables) and all(
                count[".".join(each for each, _ in tables[: deep + 1])] == index
                for deep, (_, index) in enumerate(tables)
            )
            start = number if here else start
        elif here and key and re.match(rf"\s*{re.escape(key)}\s*=", line):
            return number
    return start
