"""Table of parameters: mark, name, value, unit, default, and what the value means."""

from __future__ import annotations

from collections.abc import Mapping

import msgspec
from textual.strip import Strip

from groundstation.ui.display.wrap import wrap
from groundstation.ui.look.colours import AMBER, BACKGROUND, BLUE, DIM, FAINT, MUTED, TEXT, WHITE, YELLOW, style
from groundstation.ui.params.edit.checks import meaning_of
from groundstation.ui.params.edit.pending import PendingChange
from groundstation.ui.widgets.columns import Column, fit, header, row
from groundstation.ui.widgets.instrument import Instrument, Part, strip
from groundstation.views.params import ParamInfo, ParamRow
from link.services.param.float32 import value_text

COLUMNS = (
    Column("", 1),
    Column("name", 14, most=16),
    Column("value", 6, right=True, most=13),
    Column("unit", 5, weight=2, most=6),
    Column("default", 7, weight=1, right=True, most=8),
    Column("means", 10, weight=3, most=60),
)

TITLES = 1
"""Line of titles."""


class ParamTableValue(msgspec.Struct, frozen=True):
    """What the table draws."""

    rows: tuple[ParamRow, ...] = ()
    selected: int = -1
    """Index of the selected row in `rows`; -1: none."""
    pending: Mapping[str, PendingChange] = msgspec.field(default_factory=dict)
    infos: Mapping[str, ParamInfo] = msgspec.field(default_factory=dict)
    favourites: frozenset[str] = frozenset()
    note: str = ""
    """In place of rows, where there are none."""


class ParamTable(Instrument[ParamTableValue]):
    """A row for each parameter: ● not at its default, ✎ a change that is not sent, ★ a favourite."""

    def draw(self, width: int, height: int) -> list[Strip]:
        """Draw the titles and the page."""
        if not self.value.rows:
            return [strip((f" {line}", style(DIM))) for line in wrap(self.value.note, width - 2)]
        widths = fit(COLUMNS, width - 2)
        lines = [_framed(header(COLUMNS, widths), width)]
        for index, each in enumerate(self.value.rows[: height - TITLES]):
            ground = FAINT if index == self.value.selected else BACKGROUND
            cells = self._cells(each, widths, ground, selected=index == self.value.selected)
            lines.append(_framed(row(COLUMNS, widths, cells, style(TEXT, ground)), width, ground))
        return lines

    def _cells(self, param: ParamRow, widths: tuple[int, ...], ground: str, *, selected: bool) -> list[Part]:
        change = self.value.pending.get(param.name)
        dim = MUTED if selected else DIM
        mark, colour = self._mark(param, change)
        value = value_text(param.value) if change is None else changed_text(param.value, change.value, widths[2])
        new = BLUE if change else AMBER if param.changed else TEXT
        default = "" if param.default is None else value_text(param.default)
        meaning = meaning_of(self.value.infos.get(param.name), change.value) if change else param.meaning
        return [
            (mark, style(colour, ground)),
            (param.name, style(WHITE if selected else TEXT, ground, bold=selected)),
            (shortened(value, widths[2]), style(new, ground, bold=change is not None)),
            (param.unit, style(dim, ground)),
            (shortened(default, widths[4]), style(dim, ground)),
            (meaning, style(BLUE if change else dim, ground)),
        ]

    def _mark(self, param: ParamRow, change: PendingChange | None) -> tuple[str, str]:
        if change is not None:
            return "✎", BLUE
        if param.changed:
            return "●", AMBER
        return ("★", YELLOW) if param.name in self.value.favourites else (" ", DIM)


def changed_text(before: float, after: float, width: int) -> str:
    """Return "old→new", without the old value where there is no room."""
    old, new = value_text(before), value_text(after)
    whole = f"{old}→{new}"
    return whole if len(whole) <= width else f"→{new}"


def shortened(text: str, width: int) -> str:
    """Return a number that fits: one that is cut says so."""
    return text if len(text) <= width else f"{text[: max(0, width - 1)]}…"


def _framed(line: Strip, width: int, ground: str = BACKGROUND) -> Strip:
    """Return a line with a space at each side, filled to its width; the selected one begins with a mark."""
    space = style(TEXT, ground)
    rest = max(1, width - 1 - line.cell_length)
    mark = " " if ground == BACKGROUND else "›"
    return Strip([*strip((mark, space)), *line, *strip((" " * rest, space))]).crop(0, width)
