"""RowTable: rows in columns with a cursor that stays in sight, and notes below them."""

from __future__ import annotations

from collections.abc import Sequence

import msgspec
from textual.strip import Strip

from groundstation.ui.display.wrap import wrap
from groundstation.ui.look.colours import BACKGROUND, BLUE, DIM, FAINT, TEXT, style
from groundstation.ui.widgets.columns import Column, fit, header, row
from groundstation.ui.widgets.instrument import Instrument, strip


class Cell(msgspec.Struct, frozen=True):
    """One text of a row."""

    text: str
    colour: str = TEXT
    bold: bool = False
    bar: float | None = None
    """Share of the column that is filled, 0..1, in place of the text."""


class RowTableValue(msgspec.Struct, frozen=True):
    """What a table shows. The first column, for the cursor's mark, is the table's own."""

    columns: tuple[Column, ...]
    rows: tuple[tuple[Cell, ...], ...] = ()
    cursor: int | None = None
    """Row with the cursor; None: it is in another panel."""
    notes: tuple[Cell, ...] = ()
    """Lines below the rows, wrapped."""
    titled: bool = True
    """The titles of the columns are shown, if there are rows."""


MARK = Column("", 1)


class RowTable(Instrument[RowTableValue]):
    """Shows as many rows as fit, those around the cursor."""

    def draw(self, width: int, height: int) -> list[Strip]:
        """Draw the titles, the rows and the notes; where there is no room for all, the notes go first."""
        value = self.value
        columns = (MARK, *value.columns)
        widths = fit(columns, width)
        head = [header(columns, widths)] if value.titled and value.rows else []
        notes = self._notes(width)
        room = max(1, height - len(head))
        shown = min(len(value.rows), room)
        first = max(0, min((value.cursor or 0) - shown // 2, len(value.rows) - shown))
        rows = [
            self._row(columns, widths, number, cells)
            for number, cells in enumerate(value.rows[first : first + shown], start=first)
        ]
        return [*head, *rows, *notes][:height]

    def wanted(self, width: int) -> int:
        """Return how many lines everything needs."""
        head = 1 if self.value.titled and self.value.rows else 0
        return head + len(self.value.rows) + len(self._notes(width))

    def _row(self, columns: Sequence[Column], widths: Sequence[int], number: int, cells: tuple[Cell, ...]) -> Strip:
        marked = number == self.value.cursor
        ground = FAINT if marked else BACKGROUND
        texts = (_bar(each.bar, width) if each.bar is not None else each.text
                 for each, width in zip(cells, widths[1:], strict=True))  # fmt: skip
        looks = [(text, style(each.colour, ground, bold=each.bold)) for text, each in zip(texts, cells, strict=True)]
        mark = ("›" if marked else " ", style(BLUE, ground, bold=True))
        return row(columns, widths, [mark, *looks], style(TEXT, ground))

    def _notes(self, width: int) -> list[Strip]:
        return [
            strip((f" {line}", style(note.colour, bold=note.bold))).crop(0, width)
            for note in self.value.notes
            for line in wrap(note.text, max(10, width - 2))
        ]


def _bar(share: float, width: int) -> str:
    full = round(max(0.0, min(1.0, share)) * width)
    return "█" * full + "·" * (width - full)


def dim(text: str) -> Cell:
    """Return a cell in a quiet colour."""
    return Cell(text, DIM)
