"""Colours of the console by meaning: green is good, amber a warning, red needs action.

Over SSH and in tmux COLORTERM is often missing, and Textual then uses 256 colours; some terminals have 16. The greys
are chosen so that the nearest of 256 colours is a grey, too, and that text and background differ with 16 colours.
"""

from __future__ import annotations

from functools import cache

from rich.style import Style
from textual.theme import Theme

BACKGROUND = "#0b0e14"
PANEL = "#10151f"
LINE = "#3a4350"
TEXT = "#c9d1d9"
DIM = "#6b7684"
FAINT = "#2f353d"
MUTED = "#8f99a6"
"""Text on FAINT that is out of use: DIM and FAINT are one colour of 16."""
WARNING = "#302c24"
"""Background of warnings."""
BLUE = "#58b6ff"
GREEN = "#4ed07e"
AMBER = "#ffb04d"
YELLOW = "#ffd75f"
VIOLET = "#af87ff"
RED = "#ff5f5f"
DEEP_RED = "#b3261e"
SKY, GROUND = "#2b7cb8", "#875f2f"
WHITE = "#ffffff"
BLACK = "#0b0e14"

THEME = Theme(
    name="helm",
    primary=BLUE,
    secondary=AMBER,
    accent=YELLOW,
    foreground=TEXT,
    background=BACKGROUND,
    surface=BACKGROUND,
    panel=PANEL,
    success=GREEN,
    warning=AMBER,
    error=RED,
    dark=True,
)


@cache
def style(colour: str = TEXT, on: str = BACKGROUND, *, bold: bool = False) -> Style:
    """Return a cached style, because creating one per segment is expensive. Textual fills no background by itself."""
    return Style(color=colour, bgcolor=on, bold=bold or None)


def badge(colour: str) -> Style:
    """Return dark text on a colour, or white bold text on dark red. Bold black is grey where there are 16 colours."""
    return style(WHITE, colour, bold=True) if colour == DEEP_RED else style(BLACK, colour)
