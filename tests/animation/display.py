"""What a terminal shows after all that was written to it, by the terminal emulator pyte."""

from __future__ import annotations

import re

import pyte
from pyte.screens import Char
from rich.style import Style

from tests.groundstation.ui.frames import Picture

_UNKNOWN = re.compile(r"\x1b\[[<=>][0-9;:]*[@-~]|\x1bP.*?\x1b\\", re.DOTALL)
"""Requests and key modes, which show nothing. pyte 0.8 draws their ends as text."""

_NAMES = {"brown": "yellow", "brightbrown": "bright_yellow"}
"""pyte's names of colours that rich names in another way."""


class Display:
    """A terminal that is written to and looked at."""

    def __init__(self, width: int, height: int) -> None:
        self._screen = pyte.Screen(width, height)
        self._stream = pyte.Stream(self._screen)

    def write(self, text: str) -> None:
        """Write whole escape sequences and text."""
        self._stream.feed(_UNKNOWN.sub("", text))

    def picture(self) -> Picture:
        """Return all cells with their styles, and the cursor as a block."""
        screen = self._screen
        rows = [[_cell(screen.buffer[y][x]) for x in range(screen.columns)] for y in range(screen.lines)]
        if not screen.cursor.hidden and screen.cursor.x < screen.columns:
            character, style = rows[screen.cursor.y][screen.cursor.x]
            rows[screen.cursor.y][screen.cursor.x] = (character, style + Style(reverse=not style.reverse))
        return rows


def _cell(char: Char) -> tuple[str, Style]:
    style = Style(color=_colour(char.fg), bgcolor=_colour(char.bg), bold=char.bold, reverse=char.reverse)
    return char.data or " ", style


def _colour(name: str) -> str | None:
    """Return rich's name of a colour: pyte has `default`, names, and six digits."""
    if name == "default":
        return None
    if re.fullmatch(r"[0-9a-f]{6}", name):
        return f"#{name}"
    return _NAMES.get(name, name.replace("bright", "bright_"))
