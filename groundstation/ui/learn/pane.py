"""LessonPane: heading, text, tasks and hint of a lesson, in pages that fit."""

from __future__ import annotations

import re
from collections.abc import Sequence

import msgspec
from rich.style import Style
from textual.strip import Strip

from groundstation.ui.display.wrap import wrap
from groundstation.ui.learn.layout import HEIGHT, WIDTH, PanePlace
from groundstation.ui.look.colours import AMBER, DIM, GREEN, PANEL, TEXT, WHITE, YELLOW, style
from groundstation.ui.widgets.instrument import Instrument, strip

DONE, DUE, LATER, WRONG = "✓", "›", "·", "!"
"""Marks before a task that is done, due, or not begun, and before a hint."""


class TaskLine(msgspec.Struct, frozen=True):
    """One task, a hint, or a line of the reasons."""

    mark: str
    text: str


class LessonPaneValue(msgspec.Struct, frozen=True):
    """What the pane shows."""

    heading: str = ""
    place: PanePlace = PanePlace.HIDDEN
    text: tuple[str, ...] = ()
    """Paragraphs."""
    code: tuple[str, ...] = ()
    """Lines that are shown as they are."""
    tasks: tuple[TaskLine, ...] = ()
    """All tasks, with the hint behind the one that is due."""
    end: tuple[str, ...] = ()
    """What is said when all is done."""
    page: int = 0
    """Counted from 0; a page after the last is the last. -1: the first page with the task that is due, or the end."""
    key: str = ""
    """Key that turns the page."""


_KEY = re.compile(r"(\[[^\[\]]+\]|\[\[\]|\[\]\])")
"""A key as print_keys writes it."""

Line = tuple[str, str]
"""Mark and text; the mark is "" in a paragraph and in lines after the first."""


class LessonPane(Instrument[LessonPaneValue]):
    """At the right of a wide screen, else in six lines below it."""

    DEFAULT_CSS = f"""
    LessonPane {{ display: none; background: $panel; }}
    LessonPane.-right {{ display: block; dock: right; width: {WIDTH}; height: 100%; }}
    LessonPane.-below {{ display: block; dock: bottom; width: 100%; height: {HEIGHT}; }}
    """

    def __init__(self, value: LessonPaneValue, *, id: str | None = None) -> None:  # noqa: A002
        super().__init__(value, id=id)
        self._set_place(value.place)

    def show(self, value: LessonPaneValue) -> None:
        """Show another value, at its place."""
        if value.place is not self.value.place:
            self._set_place(value.place)
        super().show(value)

    def _set_place(self, place: PanePlace) -> None:
        self.set_class(place is PanePlace.RIGHT, "-right")
        self.set_class(place is PanePlace.BELOW, "-below")

    def draw(self, width: int, height: int) -> list[Strip]:
        """Draw the heading and one page."""
        pages = lay_out(self.value, width, height)
        at = find_page(self.value, pages)
        turn = f"{self.value.key} page {at + 1}/{len(pages)}" if len(pages) > 1 else self.value.key
        room = width - len(turn) - 1
        head = strip((f" {self.value.heading}".ljust(room)[:room], _head()), (f"{turn} ", _head()))
        return [head, *(_draw_line(line, width) for line in pages[at])]


def lay_out(value: LessonPaneValue, width: int, height: int) -> list[list[Line]]:
    """Return the pages of a pane: one where all fits, else the text, the tasks, and the end."""
    columns, rows = max(10, width - 2), max(1, height - 1)
    text = _paragraphs(value.text, columns)
    code: list[Line] = [("", line) for line in value.code]
    tasks = [line for task in value.tasks for line in _wrapped(task, columns)]
    end = _paragraphs(value.end, columns)
    whole = _apart([*(_paragraphs([each], columns) for each in value.text), code, tasks, end])
    if len(whole) <= rows:
        return [whole]
    near = [line for task in _near(value.tasks) for line in _wrapped(task, columns)]
    parts = [text, code, near, end]
    return [page for part in parts for page in _split(part, rows)] or [[]]


def find_page(value: LessonPaneValue, pages: Sequence[Sequence[Line]]) -> int:
    """Return the index of the page to show."""
    if value.page >= 0:
        return min(value.page, len(pages) - 1)
    shown = (at for at, page in enumerate(pages) if any(_is_due(value, line) for line in page))
    return next(shown, len(pages) - 1)


def _is_due(value: LessonPaneValue, line: Line) -> bool:
    return line[1] == value.end[0] if value.end else line[0] in (WRONG, DUE)


def _apart(parts: Sequence[list[Line]]) -> list[Line]:
    """Return the parts with an empty line between each two."""
    lines: list[Line] = []
    for part in filter(None, parts):
        lines += [*([("", "")] if lines else []), *part]
    return lines


def _near(tasks: Sequence[TaskLine]) -> list[TaskLine]:
    """Return what fits into few lines: the hint and the task that is due."""
    due = [task for task in tasks if task.mark == DUE]
    return [*(task for task in tasks if task.mark == WRONG), *due] or list(tasks[-1:])


def _paragraphs(texts: Sequence[str], columns: int) -> list[Line]:
    return [("", line) for text in texts for line in wrap(text, columns)]


def _wrapped(task: TaskLine, columns: int) -> list[Line]:
    first, *others = wrap(task.text, columns - 2)
    return [(task.mark, first), *((" ", other) for other in others)]


def _split(lines: list[Line], rows: int) -> list[list[Line]]:
    return [lines[at : at + rows] for at in range(0, len(lines), rows)]


def _head() -> Style:
    return style(WHITE, PANEL, bold=True)


def _draw_line(line: Line, width: int) -> Strip:
    mark, text = line
    look = {DONE: GREEN, DUE: YELLOW, WRONG: AMBER, LATER: DIM}.get(mark, TEXT)
    lead = f" {mark} " if mark else " "
    parts = [(lead, style(look, PANEL, bold=True))]
    ink = look if mark in (LATER, DONE) else TEXT
    for at, part in enumerate(_KEY.split(text)):
        is_key = bool(at % 2)
        parts.append((part, style(YELLOW if is_key else ink, PANEL, bold=is_key)))
    used = sum(len(part) for part, _ in parts)
    return strip(*parts, (" " * max(0, width - used), style(TEXT, PANEL)))
