"""Message detail: the fields of one message with values, units and meanings, and the bits of bitmasks."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import msgspec
from rich.style import Style
from textual.strip import Strip

from groundstation.ui.display.wrap import clean, wrap
from groundstation.ui.look.colours import AMBER, BLUE, DIM, GREEN, TEXT, selected, style
from groundstation.ui.widgets.instrument import Instrument, Part, strip
from groundstation.views.messages import MessageField, MessageView

WIDE = 70
"""Cells from which on value, unit and meaning have columns of their own."""
VALUE, UNIT, MEANING, SPARK = 16, 7, 11, 9
"""Cells of the columns; names that leave no room for the others are cut."""
MARKS = "✓✗·"
INDENT = 3
SHARE = 0.55
"""Of the width: the longest name of a field in the narrow form."""
UNKNOWN = "this id is in no dialect known here: start with --dialect FILE.xml, the file of the vehicle's dialect"


class MessageDetailValue(msgspec.Struct, frozen=True):
    """A message, the first of its lines that is shown, and the chosen field."""

    view: MessageView | None = None
    top: int = 0
    chosen: str = ""
    raw: bool = False
    """Values as they are sent, without units that people use and without names of enum values."""


class DetailLine(msgspec.Struct, frozen=True):
    """A line, and the field that it belongs to."""

    field: str
    parts: list[Part]


class MessageDetail(Instrument[MessageDetailValue]):
    """One line per field; long texts and flags take lines of their own below it. The bytes come last."""

    def draw(self, width: int, height: int) -> list[Strip]:
        """Draw the lines from `top` on, those of the chosen field on a ground of their own."""
        value = self.value
        if value.view is None:
            return [strip((" choose a message with ↑ ↓"[:width], style(DIM)))]
        lines = detail_lines(value.view, width, raw=value.raw)[value.top :][:height]
        return [self._line(line, width) for line in lines]

    def _line(self, line: DetailLine, width: int) -> Strip:
        if not line.field or line.field != self.value.chosen:
            return strip(*line.parts).crop(0, width)
        (first, look), *rest = line.parts
        marked = [(f"›{first[1:]}", look), *rest]
        drawn = strip(*((text, look + selected()) for text, look in marked)).crop(0, width)
        return drawn.extend_cell_length(width, selected())


def detail_lines(view: MessageView, width: int, *, raw: bool = False) -> list[DetailLine]:
    """Return all lines of a message."""
    names = max((len(each.name) for each in view.fields), default=0)
    room = min(names, int(width * SHARE)) + 1
    lines: list[DetailLine] = []
    if not view.fields:
        return [DetailLine("", [(f" {line}", style(DIM))]) for line in wrap(UNKNOWN, width - 1)]
    columns = _columns(view.fields, width)
    for each in view.fields:
        shown = msgspec.structs.replace(each, meaning="", flags=()) if raw else each
        drawn = _wide(shown, columns, width) if width >= WIDE else _narrow(shown, room, width)
        lines += (DetailLine(each.name, parts) for parts in drawn)
        lines += (DetailLine("", parts) for parts in _flags(shown.flags, width))
    return [*lines, *(DetailLine("", parts) for parts in _bytes(view.payload, width))]


def _flags(flags: Sequence[str], width: int) -> Iterator[list[Part]]:
    """Yield the lines of flags, in two columns where they fit."""
    longest = max(map(len, flags), default=0) + INDENT
    columns = 2 if len(flags) > 4 and 2 * longest + INDENT <= width else 1
    rows = -(-len(flags) // columns)
    if any(flag[:1] in MARKS for flag in flags):
        yield [(" " * INDENT + "PEH: present, enabled, healthy", style(DIM))]
    for row in range(rows):
        shown = [(f"{clean(flag):<{longest}}", _flag_style(flag)) for flag in flags[row::rows]]
        yield [(" " * INDENT, style(TEXT)), *shown]


def _bytes(payload: bytes, width: int) -> Iterator[list[Part]]:
    """Yield the lines of the payload in hexadecimal."""
    if payload:
        yield from ([(f" {line}", style(DIM))] for line in wrap(f"bytes {payload.hex(' ')}", width - 1))


def _columns(fields: Sequence[MessageField], width: int) -> tuple[int, int]:
    """Return the cells for names and for values; a longer value stands below its name."""
    values = max((len(each.value) for each in fields if len(each.value) <= VALUE), default=1)
    names = max(len(each.name) for each in fields) + 1
    return min(names, width - values - UNIT - MEANING - SPARK - 2), values


def _wide(field: MessageField, columns: tuple[int, int], width: int) -> Iterator[list[Part]]:
    names, values = columns
    name = (f" {clean(field.name)[: names - 1]:<{names}}", style(TEXT))
    value, meaning = clean(field.value), clean(field.meaning)
    if len(value) > values:
        yield [name]
        yield from ([(" " * INDENT + line, style(TEXT))] for line in wrap(value, width - INDENT))
        return
    unit = (f" {field.unit:<{UNIT}}", style(DIM))
    shown = (value.rjust(values), style(DIM if meaning else TEXT))
    room = width - names - values - UNIT - 2 - SPARK
    spark = (clean(field.spark).rjust(SPARK), style(BLUE))
    if len(meaning) <= room:
        yield [name, shown, unit, (f"{meaning:<{room}}", _meaning_style(field)), spark]
        return
    yield [name, shown, unit, (" " * room, style()), spark]
    yield from ([(" " * INDENT + line, _meaning_style(field))] for line in wrap(meaning, width - INDENT))


def _narrow(field: MessageField, room: int, width: int) -> Iterator[list[Part]]:
    name = (f" {clean(field.name)[: room - 1]:<{room}}", style(TEXT))
    text = clean(field.meaning or f"{field.value} {field.unit}".rstrip())
    look = _meaning_style(field) if field.meaning else style(TEXT)
    if len(text) <= width - room - 1:
        left = width - room - len(text) - 1
        spark = [(clean(field.spark).rjust(left), style(BLUE))] if left > SPARK else []
        yield [name, (text, look), *spark]
        return
    yield [(f" {clean(field.name)}", style(TEXT))]
    yield from ([(" " * INDENT + line, look)] for line in wrap(text, width - INDENT))


def _meaning_style(field: MessageField) -> Style:
    return style(AMBER if field.meaning.endswith("not healthy") else GREEN)


def _flag_style(flag: str) -> Style:
    """Return the style of a flag; those of SYS_STATUS begin with a mark for present, enabled and healthy each."""
    marks = flag[:3] if flag[:1] in MARKS else ""
    return style(AMBER if "✗" in marks else DIM if marks.endswith("·") else TEXT)
