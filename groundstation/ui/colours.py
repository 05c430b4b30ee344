"""Colours of the console by meaning: green is good, amber a warning, red needs action."""

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
    """Return a cached style, because creating one per segment is expensive. Textual fills no background by itself."""
    return Style(color=colour, bgcolor=on, bold=bold or None)


def badge(colour: str) -> Style:
    """Return dark bold text on a colour, or white text on dark red."""
    return style(WHITE if colour == DEEP_RED else BLACK, colour, bold=True)
