"""Message detail: the fields of one message with values, units and meanings, and the bits of bitmasks."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from rich.style import Style
from textual.strip import Strip

from groundstation.ui.colours import AMBER, DIM, GREEN, TEXT, style
from groundstation.ui.widgets.instrument import Instrument, Part, strip
from groundstation.ui.wrap import clean, wrap
from groundstation.views.messages import MessageField, MessageView

WIDE = 70
"""Cells from which on value, unit and meaning have columns of their own."""
VALUE, UNIT, MEANING = 16, 7, 14
"""Cells of the columns; names that leave no room for the others are cut."""
INDENT = 3
SHARE = 0.55
"""Of the width: the longest name of a field in the narrow form."""
UNKNOWN = "this id is in no dialect known here: start with --dialect FILE.xml, the file of the vehicle's dialect"


@dataclass(frozen=True, slots=True)
class MessageDetailValue:
    """A message, and the first of its lines that is shown."""

    view: MessageView | None = None
    top: int = 0


class MessageDetail(Instrument[MessageDetailValue]):
    """One line per field; long texts and flags take lines of their own below it."""

    def draw(self, width: int, height: int) -> list[Strip]:
        """Draw the lines from `top` on."""
        view = self.value.view
        if view is None:
            return [strip((" choose a message with ↑ ↓"[:width], style(DIM)))]
        return [strip(*parts).crop(0, width) for parts in detail_lines(view, width)[self.value.top :][:height]]


def detail_lines(view: MessageView, width: int) -> list[list[Part]]:
    """Return all lines of a message."""
    names = max((len(each.name) for each in view.fields), default=0)
    room = min(names, int(width * SHARE)) + 1
    lines: list[list[Part]] = []
    if not view.fields:
        return [[(f" {line}", style(DIM))] for line in wrap(UNKNOWN, width - 1)]
    for each in view.fields:
        lines += (
            _wide(each, min(names + 1, width - VALUE - UNIT - MEANING - 2), width)
            if width >= WIDE
            else _narrow(each, room, width)
        )
        lines += ([(" " * INDENT + clean(flag), _flag_style(flag))] for flag in each.flags)
    return lines


def _wide(field: MessageField, names: int, width: int) -> Iterator[list[Part]]:
    name = (f" {clean(field.name)[: names - 1]:<{names}}", style(TEXT))
    value, meaning = clean(field.value), clean(field.meaning)
    if len(value) > VALUE:
        yield [name]
        yield from ([(" " * INDENT + line, style(TEXT))] for line in wrap(value, width - INDENT))
        return
    unit = (f" {field.unit:<{UNIT}}", style(DIM))
    shown = (value.rjust(VALUE), style(DIM if meaning else TEXT))
    if names + VALUE + UNIT + 2 + len(meaning) <= width:
        yield [name, shown, unit, (meaning, _meaning_style(field))]
        return
    yield [name, shown, unit]
    yield from ([(" " * INDENT + line, _meaning_style(field))] for line in wrap(meaning, width - INDENT))


def _narrow(field: MessageField, room: int, width: int) -> Iterator[list[Part]]:
    name = (f" {clean(field.name)[: room - 1]:<{room}}", style(TEXT))
    text = clean(field.meaning or f"{field.value} {field.unit}".rstrip())
    look = _meaning_style(field) if field.meaning else style(TEXT)
    if len(text) <= width - room - 1:
        yield [name, (text, look)]
        return
    yield [(f" {clean(field.name)}", style(TEXT))]
    yield from ([(" " * INDENT + line, look)] for line in wrap(text, width - INDENT))


def _meaning_style(field: MessageField) -> Style:
    return style(AMBER if field.meaning.endswith("not healthy") else GREEN)


def _flag_style(flag: str) -> Style:
    return style(AMBER if flag.startswith("✗") else DIM if flag.startswith("·") else TEXT)
