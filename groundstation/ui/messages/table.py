"""Message table: sources and their messages with rates, and the row at the cursor."""

from __future__ import annotations

from collections.abc import Iterator

import msgspec
from textual.strip import Strip

from groundstation.ui.display.wrap import clean, wrap
from groundstation.ui.look.colours import AMBER, BACKGROUND, BLUE, DIM, FAINT, GREEN, TEXT, style
from groundstation.ui.widgets.columns import cut
from groundstation.ui.widgets.instrument import Instrument, Part, length, strip
from groundstation.views.messages import MessageRow

WIDE = 60
"""Cells from which on all columns are shown."""

SILENT = 0.05
"""Messages/s below which a message counts as silent."""


class MessageTableValue(msgspec.Struct, frozen=True):
    """The rows in the window."""

    rows: tuple[MessageRow, ...] = ()
    selected: int = -1
    """Index of the row at the cursor; -1: it is not in the window."""
    tree: bool = True
    """Messages stand under their source."""
    closed: frozenset[tuple[int, int, bool]] = frozenset()
    """Sources whose messages are not listed."""
    note: str = ""
    """Below the rows."""


class MessageTable(Instrument[MessageTableValue]):
    """A line of titles, then one line per row."""

    def draw(self, width: int, height: int) -> list[Strip]:
        """Draw the rows, the one at the cursor on a ground of its own."""
        lines = [_titles(width)]
        for number, row in enumerate(self.value.rows[: height - 1]):
            lines.append(self._line(row, width, chosen=number == self.value.selected))
        if self.value.note:
            lines += [strip((f" {line}", style(DIM))).crop(0, width) for line in wrap(self.value.note, width - 2)]
        return lines[:height]

    def _line(self, row: MessageRow, width: int, *, chosen: bool) -> Strip:
        ground = FAINT if chosen else BACKGROUND
        numbers = list(_numbers(row, width, ground))
        head = self._head(row, ground, chosen=chosen)
        room = width - length(numbers)
        name = strip(*_fitting(head, room))
        return Strip([*name, *strip((" " * (room - name.cell_length), style(TEXT, ground)), *numbers)])

    def _head(self, row: MessageRow, ground: str, *, chosen: bool) -> list[Part]:
        mark = "›" if chosen else " "
        source = f"{row.system}/{row.component}"
        colour = AMBER if row.sent else BLUE
        if not row.name:
            closed = (row.system, row.component, row.sent) in self.value.closed
            return [
                (f"{mark}{'▶' if closed else '▼'} ", style(DIM, ground)),
                (f"{source} ", style(colour, ground, bold=True)),
                (clean(row.label), style(DIM, ground)),
            ]
        colour_of_name = AMBER if row.sent else DIM if row.unknown else TEXT
        name = (f"{row.name} >" if row.sent else row.name, style(colour_of_name, ground, bold=chosen))
        length_of_frame = [(f"  {row.label}", style(DIM, ground))] if row.unknown else []
        lead = [] if self.value.tree else [(f"{source} ", style(colour, ground))]
        return [(f"{mark}  " if self.value.tree else f"{mark} ", style(DIM, ground)), *lead, name, *length_of_frame]


def _fitting(head: list[Part], room: int) -> list[Part]:
    """Return the parts in front of the numbers; of a long name the end goes first, and not the sign that it is sent."""
    over = length(head) - room
    if over <= 0:
        return head
    *lead, (text, look) = head
    sign = " >" if text.endswith(" >") else ""
    kept = cut(text.removesuffix(sign), max(1, len(text) - over - len(sign)))
    return [*lead, (kept + sign, look)]


def _titles(width: int) -> Strip:
    right = "Hz".rjust(6) + ("B/s".rjust(8) if width >= WIDE else "") + "age s".rjust(6)
    right += ("lost".rjust(7) + "count".rjust(8)) if width >= WIDE else ""
    return strip((" source, message".ljust(width - len(right) - 1)[: width - len(right) - 1] + right, style(DIM)))


def _numbers(row: MessageRow, width: int, ground: str) -> Iterator[Part]:
    """Yield the columns behind the name, and a space."""
    silent = row.rate < SILENT
    yield ("" if silent else f"{row.rate:.1f}").rjust(6), style(GREEN, ground, bold=not row.name)
    if width >= WIDE:
        yield ("" if silent else f"{row.bytes:.0f}").rjust(8), style(TEXT, ground)
    yield (format_age(row.age) if row.name else "").rjust(6), style(AMBER if silent else DIM, ground)
    if width >= WIDE:
        loss = "" if row.loss is None else f"{row.loss:.1%}"
        yield loss.rjust(7), style(AMBER if row.loss else DIM, ground)
        yield str(row.count).rjust(8), style(DIM, ground)
    yield " ", style(TEXT, ground)


def format_age(age: float) -> str:
    """Return s with one decimal below 100."""
    return f"{age:.1f}" if age < 99.95 else f"{age:.0f}"
