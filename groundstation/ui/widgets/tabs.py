"""Tab bar: the screens and the key of each."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from textual.strip import Strip

from groundstation.input.keymap import Keymap
from groundstation.screens import SCREENS, ScreenRow
from groundstation.ui.colours import DIM, FAINT, WHITE, YELLOW, style
from groundstation.ui.display_state import DisplayState
from groundstation.ui.keynames import format_key, main_key
from groundstation.ui.tab_marks import TabMark, find_marks
from groundstation.ui.widgets.instrument import Instrument, Part, length, strip

WIDE = 120
"""Columns from which on the keys of the screens are shown, below them the digits of the go-to menu."""


@dataclass(frozen=True, slots=True)
class TabBarValue:
    """The screen on top, and the marks of all screens."""

    keymap: Keymap
    screen: str = "drive"
    marks: Mapping[str, TabMark] = field(default_factory=dict)
    """By the id of the screen."""

    @classmethod
    def from_state(cls, now: DisplayState) -> TabBarValue:
        """Return the tab bar of a display state."""
        return cls(now.keymap, now.screen.id, find_marks(now))


class TabBar(Instrument[TabBarValue]):
    """One line: a screen after the other, the one on top bold on a ground of its own."""

    def draw(self, width: int, height: int) -> list[Strip]:
        """Draw the tabs that fit, and the key of the go-to menu at the right edge."""
        parts: list[Part] = []
        right = goto_parts(self.value.keymap)
        for row in SCREENS:
            tab = self._tab(row, width) if row.in_tabs else []
            if length(parts) + length(tab) + length(right) <= width:
                parts += tab
        gap = max(0, width - length(parts) - length(right))
        return [strip(*parts, (" " * gap, style()), *right).crop(0, width)]

    def _tab(self, row: ScreenRow, width: int) -> list[Part]:
        key = main_key(self.value.keymap, row.action) if width >= WIDE else None
        shown = format_key(key) if key else row.digit
        mark = self.value.marks.get(row.id)
        text = "" if mark is None else mark.text if width >= WIDE else mark.short or mark.text
        colour = DIM if mark is None else mark.colour
        if row.id == self.value.screen:
            name = (f" {shown} {row.title}", style(WHITE, FAINT, bold=True))
            return [name, (text, style(colour, FAINT, bold=True)), (" ", style(WHITE, FAINT))]
        return [(f" {shown} ", style(YELLOW)), (row.title, style(DIM)), (text, style(colour)), (" ", style(DIM))]


def goto_parts(keymap: Keymap) -> list[Part]:
    """Return the key of the go-to menu with its label."""
    keys = keymap.get_keys("app.goto")
    return [(f" {format_key(keys[0])} ", style(YELLOW)), ("Go to ", style(DIM))] if keys else []
