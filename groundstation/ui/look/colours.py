"""The colours in use: the roles by their usual names, and the style of a text in the theme that is chosen."""

from __future__ import annotations

from functools import cache

from rich.style import Style

from groundstation.config.settings import ThemeName
from groundstation.ui.look.roles import Role
from groundstation.ui.look.themes import THEMES, choose_colours

BACKGROUND, PANEL, LINE = Role.BACKGROUND, Role.PANEL, Role.LINE
TEXT, DIM, FAINT, MUTED, WHITE, BLACK = (
    Role.TEXT, Role.DIM, Role.SELECTED, Role.MUTED, Role.STRONG, Role.ON_BADGE
)  # fmt: skip
WARNING, DEEP_RED = Role.NOTE, Role.DANGER
BLUE, GREEN, AMBER, YELLOW, RED = Role.INFO, Role.GOOD, Role.CAUTION, Role.KEY, Role.BAD
SKY, GROUND, VIOLET = Role.SKY, Role.EARTH, Role.REPLAY


class _InUse:
    """The theme of the one screen of this process."""

    def __init__(self) -> None:
        self.name, self.sixteen = ThemeName.DARK, False
        self.colours = choose_colours(self.name, sixteen=False)
        self.changes = 0


_in_use = _InUse()


def use_theme(name: ThemeName, *, sixteen: bool = False) -> None:
    """Draw in this theme from now on; `sixteen`: the terminal has 16 colours."""
    _in_use.name, _in_use.sixteen = name, sixteen
    _in_use.colours = choose_colours(name, sixteen=sixteen)
    _in_use.changes += 1
    style.cache_clear()


def theme_changes() -> int:
    """Return how often the theme has changed: what was drawn before is out of date."""
    return _in_use.changes


@cache
def style(colour: str = TEXT, on: str = BACKGROUND, *, bold: bool = False) -> Style:
    """Return the style of text with the role `colour` on the role `on`. Textual fills no background by itself.

    It is cached, because creating one per segment is expensive: do not keep it in a constant.
    """
    ink, ground = Role(colour), Role(on)
    if THEMES[_in_use.name].attributes:
        return _attributes(ink, ground, bold)
    if ground is Role.SELECTED:
        ink = Role.ON_SELECTED if _in_use.sixteen else Role.MUTED if ink is Role.DIM else ink
    return Style(color=_in_use.colours[ink], bgcolor=_in_use.colours[ground], bold=bold or None)


_BADGES = frozenset(
    {
        Role.DANGER,
        Role.BAD,
        Role.CAUTION,
        Role.KEY,
        Role.GOOD,
        Role.INFO,
        Role.EARTH,
        Role.REPLAY,
    }
)
"""Grounds that are drawn in reverse without colours, for badges and for the part of a bar in one cell."""

_LOUD = frozenset({Role.BAD, Role.CAUTION, Role.KEY, Role.STRONG})
"""Text that is bold without colours."""


def _attributes(ink: Role, ground: Role, bold: bool) -> Style:
    """Return the style without colours: loud badges in reverse, the selected row and what is bad underlined."""
    quiet = ink is Role.ON_BADGE and ground in (
        Role.INFO,
        Role.GOOD,
    )  # beside ARMED, which must stand out
    return Style(
        bold=bold or quiet or ink in _LOUD or ground is Role.DANGER or None,
        reverse=(ground in _BADGES and not quiet) or None,
        underline=ground in (Role.SELECTED, Role.BAD) or ink is Role.BAD or None,
    )


def selected() -> Style:
    """Return what the selected row adds to the style of its text."""
    if THEMES[_in_use.name].attributes:
        return Style(underline=True)
    return Style(bgcolor=_in_use.colours[Role.SELECTED])


def badge(colour: str) -> Style:
    """Return a style for text on a colour. Bold black is grey where there are 16 colours, so it is not bold."""
    return style(Role.ON_DANGER, colour, bold=True) if colour == DEEP_RED else style(BLACK, colour)
