"""Columns of a table: which of them fit a width, and a row in them."""

from __future__ import annotations

from collections.abc import Sequence

import msgspec
from rich.style import Style
from textual.strip import Strip

from groundstation.ui.display.wrap import clean
from groundstation.ui.look.colours import DIM, style
from groundstation.ui.widgets.instrument import Part, strip

GAP = 1
"""Cells between two columns."""
LEAST_CUT = 8
"""Cells from which on a text that is cut says so."""


class Column(msgspec.Struct, frozen=True):
    """One column. Those of small weight stay longest where the line is short."""

    title: str
    width: int
    weight: int = 0
    right: bool = False
    """Aligned to the right, as numbers are."""
    most: int = 0
    """Width up to which it grows where there is room; 0: it does not."""


def fit(columns: Sequence[Column], width: int) -> tuple[int, ...]:
    """Return the width of each column, 0 for those that do not fit; the room that is left goes to those that grow."""
    chosen: list[Column] = []
    for column in sorted(columns, key=lambda each: each.weight):
        if sum(each.width + GAP for each in (*chosen, column)) - GAP > width:
            break  # what weighs more is worth less: no unit stands where its value did not fit
        chosen.append(column)
    left = width - sum(each.width + GAP for each in chosen) + GAP
    widths = []
    for column in columns:
        grown = min(left, max(0, column.most - column.width)) if column in chosen else 0
        left -= grown
        widths.append(column.width + grown if column in chosen else 0)
    return tuple(widths)


def row(columns: Sequence[Column], widths: Sequence[int], cells: Sequence[Part], gap: Style | None = None) -> Strip:
    """Return a row of cells, cut where they are too long; `gap` is the look of the space between them."""
    parts: list[Part] = []
    for column, width, (text, look) in zip(columns, widths, cells, strict=True):
        if width:
            text = cut(clean(text), width)
            text = text.rjust(width) if column.right else text.ljust(width)
            parts += [*([(" " * GAP, gap or style())] if parts else []), (text, look)]
    return strip(*parts)


def cut(text: str, width: int) -> str:
    """Return a text that fits a width; one that is cut ends with an ellipsis, unless that would leave little of it."""
    return text if len(text) <= width else f"{text[: width - 1]}…" if width >= LEAST_CUT else text[:width]


def header(columns: Sequence[Column], widths: Sequence[int]) -> Strip:
    """Return the row of the titles."""
    return row(columns, widths, [(column.title, style(DIM)) for column in columns])
