"""The colours of the console, by meaning: green is well, amber wants a look, red wants a hand."""

from __future__ import annotations

from functools import cache

from rich.style import Style
from textual.theme import Theme

BACKGROUND = "#0b0e14"
PANEL = "#10151f"
LINE = "#3a4350"
TEXT = "#c9d1d9"
DIM = "#6b7684"
FAINT = "#2b3440"
BLUE = "#58b6ff"
GREEN = "#4ed07e"
AMBER = "#ffb04d"
YELLOW = "#ffd75f"
RED = "#ff5f5f"
DEEP_RED = "#b3261e"
SKY, GROUND = "#2b7cb8", "#573a20"
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
    """A ready-made style: making one anew for each segment is what costs. Textual fills no ground, so it is said."""
    return Style(color=colour, bgcolor=on, bold=bold or None)


def badge(colour: str) -> Style:
    """Dark bold letters on a colour; white ones on a dark red."""
    return style(WHITE if colour == DEEP_RED else BLACK, colour, bold=True)
