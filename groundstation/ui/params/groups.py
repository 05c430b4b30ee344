"""List of groups: all, changed, pending, favourites, and the beginnings of names."""

from __future__ import annotations

import msgspec
from textual.strip import Strip

from groundstation.ui.display.wrap import clean
from groundstation.ui.look.colours import AMBER, BACKGROUND, BLUE, DIM, FAINT, TEXT, YELLOW, style
from groundstation.ui.params.scope import ALL, ParamScope, ScopeKind, ScopeRow
from groundstation.ui.widgets.instrument import Instrument, strip

_MARKS = {
    ScopeKind.CHANGED: ("●", AMBER),
    ScopeKind.PENDING: ("✎", BLUE),
    ScopeKind.FAVOURITES: ("★", YELLOW),
}


class GroupListValue(msgspec.Struct, frozen=True):
    """The rows, the one at the cursor, and the one that the table shows."""

    rows: tuple[ScopeRow, ...] = ()
    cursor: int = 0
    shown: ParamScope = ALL
    chosen: bool = False
    """The panel has the arrows."""


class GroupList(Instrument[GroupListValue]):
    """A line for each group: ✓ the one in the table, its marks, and how many parameters it has."""

    def draw(self, width: int, height: int) -> list[Strip]:
        """Draw the rows around the cursor; the last line counts those below."""
        rows, cursor = self.value.rows, self.value.cursor
        top = max(0, min(cursor - height // 2, len(rows) - height))
        shown = rows[top : top + height]
        below = len(rows) - top - len(shown)
        lines = [self._line(each, top + at == cursor, width) for at, each in enumerate(shown)]
        if below > 0:
            lines[-1] = strip((f" {below + 1} more ↓"[:width], style(DIM)))
        return lines

    def _line(self, each: ScopeRow, chosen: bool, width: int) -> Strip:
        chosen = chosen and self.value.chosen
        ground = FAINT if chosen else BACKGROUND
        lead, colour = ("✓", TEXT) if each.scope == self.value.shown else _MARKS.get(each.scope.kind, (" ", DIM))
        mark, tint = ("✎", BLUE) if each.pending else ("●", AMBER) if each.changed else (" ", DIM)
        count = f"{each.count:>5} "
        name = f" {clean(each.scope.label)}"[: width - len(count) - 4]
        gap = max(0, width - len(name) - len(count) - 4)
        return strip(
            ("›" if chosen else " ", style(TEXT, ground)),
            (lead, style(colour, ground)),
            (name, style(TEXT, ground, bold=each.scope == self.value.shown)),
            (" " * gap, style(TEXT, ground)),
            (f"{mark} ", style(tint, ground)),
            (count, style(DIM if not chosen else TEXT, ground)),
        ).crop(0, width)
