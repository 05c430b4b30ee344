"""Where a file and the vehicle differ."""

from __future__ import annotations

import msgspec
from textual.strip import Strip

from groundstation.ui.display.wrap import clean
from groundstation.ui.look.colours import AMBER, BACKGROUND, DIM, FAINT, GREEN, TEXT, style
from groundstation.ui.params.table import shortened
from groundstation.ui.widgets.instrument import Instrument, Part, strip
from groundstation.views.params import ParamDiff
from link.services.param.float32 import value_text

COUNTS = 2
"""Lines of counts above the differences."""
NAME = 17


class CompareValue(msgspec.Struct, frozen=True):
    """The comparison, the row at the cursor, and the names with a change that is not written."""

    diff: ParamDiff | None = None
    cursor: int = 0
    pending: frozenset[str] = frozenset()
    chosen: bool = False
    """The panel has the arrows."""


class CompareList(Instrument[CompareValue]):
    """The counts, then a line for each difference: here → in the file; then what is not taken from the file."""

    def draw(self, width: int, height: int) -> list[Strip]:
        """Draw the differences around the cursor."""
        diff = self.value.diff
        if diff is None:
            return [strip((" comparing", style(DIM)))]
        rows = _rows(self.value, width)
        room = max(1, height - COUNTS)
        top = max(0, min(self.value.cursor - room // 2, len(rows) - room))
        return [strip(*parts).crop(0, width) for parts in (*_counts(diff, width), *rows[top : top + room])]


def _counts(diff: ParamDiff, width: int) -> list[list[Part]]:
    def line(left: str, one: int, right: str, other: int, colour: str) -> list[Part]:
        half = width // 2 - 1
        return [
            (f" {left:<10}", style(DIM)), (f"{one:>5}".ljust(half - 10), style(colour, bold=True)),
            (f"{right:<15}", style(DIM)), (f"{other:>5}", style(TEXT)),
        ]  # fmt: skip

    return [
        line("same", diff.same, "only on vehicle", diff.only_vehicle, GREEN),
        line("different", len(diff.different), "only in file", len(diff.only_file), AMBER),
    ]


def _rows(value: CompareValue, width: int) -> list[list[Part]]:
    diff = value.diff
    assert diff is not None
    rows: list[list[Part]] = []
    half = max(5, (width - NAME - 7) // 2)
    for at, (name, here, there) in enumerate(diff.different):
        at_cursor = value.chosen and at == value.cursor
        ground, lead = (FAINT, "›") if at_cursor else (BACKGROUND, " ")
        mark = "✎" if name in value.pending else " "
        rows.append([
            (f"{lead}{mark} {clean(name):<{NAME}}", style(TEXT, ground)),
            (f"{shortened(value_text(here), half):>{half}} → ", style(DIM, ground)),
            (f"{shortened(value_text(there), half):<{half}}", style(AMBER, ground)),
        ])  # fmt: skip
    rows += ([(f"   {clean(name):<{NAME}} left out: its own", style(DIM))] for name in diff.left_out)
    rows += ([(f"   {clean(name):<{NAME}} not on the vehicle", style(DIM))] for name in diff.only_file)
    return rows or [[(" the file and the vehicle agree", style(GREEN))]]
