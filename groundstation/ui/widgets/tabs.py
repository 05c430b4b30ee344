"""Tab bar: the screens and the key of each."""

from __future__ import annotations

from collections.abc import Mapping

import msgspec
from textual.strip import Strip

from groundstation.input.keymap import Keymap
from groundstation.screens import SCREENS, ScreenRow
from groundstation.ui.display.display_state import DisplayState
from groundstation.ui.display.tab_marks import TabMark, find_marks
from groundstation.ui.keys.keynames import format_key, main_key
from groundstation.ui.look.colours import DIM, FAINT, WHITE, YELLOW, style
from groundstation.ui.widgets.instrument import Instrument, Part, length, strip

WIDE = 120
"""Columns from which on the keys of the screens are shown, below them the digits of the go-to menu."""

GOTO_WIDTH = 10
"""Cells of the go-to menu's key with its label."""


class TabBarValue(msgspec.Struct, frozen=True):
    """The screen on top, and the marks of all screens."""

    keymap: Keymap
    screen: str = "drive"
    marks: Mapping[str, TabMark] = msgspec.field(default_factory=dict)
    """By the id of the screen."""

    @classmethod
    def from_state(cls, now: DisplayState) -> TabBarValue:
        """Return the tab bar of a display state."""
        return cls(now.keymap, now.screen.id, find_marks(now))


class TabBar(Instrument[TabBarValue]):
    """One line: a screen after the other, the one on top bold on a ground of its own."""

    def draw(self, width: int, height: int) -> list[Strip]:
        """Draw the tabs that fit, always with the one on top, and the key of the go-to menu at the right edge."""
        right = goto_parts(self.value.keymap, label=width >= WIDE)
        tabs = self._fitting(width - length(right))
        gap = max(0, width - length(tabs) - length(right))
        return [strip(*tabs, (" " * gap, style()), *right).crop(0, width)]

    def _fitting(self, room: int) -> list[Part]:
        """Return the tabs that have room."""
        wide = room >= WIDE - GOTO_WIDTH
        return [part for row in self._fitting_rows(room) for part in self._tab(row, wide=wide)]

    def _fitting_rows(self, room: int) -> list[ScreenRow]:
        """Return the screens whose tabs have room; those that are farthest from the one on top go first."""
        rows = [row for row in SCREENS if row.in_tabs]
        widths = [length(self._tab(row, wide=room >= WIDE - GOTO_WIDTH)) for row in rows]
        top = next((at for at, row in enumerate(rows) if row.id == self.value.screen), 0)
        while len(rows) > 1 and sum(widths) > room:
            at = 0 if top > len(rows) // 2 else len(rows) - 1
            del rows[at], widths[at]
            top -= at == 0
        return rows

    def tab_at(self, column: int) -> ScreenRow | None:
        """Return the screen whose tab is drawn at a column."""
        wide = self._room >= WIDE - GOTO_WIDTH
        begin = 0
        for row in self._fitting_rows(self._room):
            begin += length(self._tab(row, wide=wide))
            if column < begin:
                return row
        return None

    @property
    def _room(self) -> int:
        width = self.size.width
        return width - length(goto_parts(self.value.keymap, label=width >= WIDE))

    def _tab(self, row: ScreenRow, *, wide: bool) -> list[Part]:
        key = main_key(self.value.keymap, row.action) if wide else None
        shown = format_key(key) if key else row.digit
        title = row.title if wide else row.short or row.title
        mark = self.value.marks.get(row.id)
        text = "" if mark is None else mark.text if wide else mark.short or mark.text
        colour = DIM if mark is None else mark.colour
        end = " " if wide else ""
        if row.id == self.value.screen:
            name = (f" {shown} {title}", style(WHITE, FAINT, bold=True))
            return [name, (text, style(colour, FAINT, bold=True)), (end, style(WHITE, FAINT))]
        return [(f" {shown} ", style(YELLOW)), (title, style(DIM)), (text, style(colour)), (end, style(DIM))]


def goto_parts(keymap: Keymap, *, label: bool = True) -> list[Part]:
    """Return the key of the go-to menu, with its label where there is room."""
    keys = keymap.get_keys("app.goto")
    if not keys:
        return []
    return [(f" {format_key(keys[0])} ", style(YELLOW)), *([("Go to ", style(DIM))] if label else [])]
