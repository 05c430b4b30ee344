"""THEMES: the colour of each role in each theme. A new theme is a row here and its name in ThemeName.

Over SSH and in tmux COLORTERM is often missing, and Textual then uses 256 colours; the Linux console and xterm without
it have 16. Rich takes the nearest one. The colours are chosen so that all text stays readable then (4.5:1, WCAG 2.1
1.4.3; tests/groundstation/ui/look/test_themes.py computes it). Where the nearest of 16 does not, `sixteen` has another.
"""

from __future__ import annotations

from collections.abc import Mapping

import msgspec
from textual.theme import Theme

from groundstation.config.settings import ThemeName
from groundstation.ui.look.roles import Role

Colours = Mapping[Role, str]


class ColourTheme(msgspec.Struct, frozen=True):
    """One theme."""

    help: str
    colours: Colours
    sixteen: Colours = msgspec.field(default_factory=dict)
    """Colours in place of those where there are 16. Their values are those of Rich's standard palette."""
    dark: bool = True
    attributes: bool = False
    """Bold, reverse and underline in place of colours; the colours are those of Textual's own widgets."""


_DARK = {
    Role.BACKGROUND: "#0b0e14", Role.PANEL: "#10151f", Role.SELECTED: "#2b2f35", Role.NOTE: "#302c24",
    Role.DANGER: "#b3261e", Role.LINE: "#3a4350", Role.TEXT: "#c9d1d9", Role.STRONG: "#ffffff", Role.DIM: "#7d8794",
    Role.MUTED: "#a3adb9", Role.INFO: "#58b6ff", Role.KEY: "#ffd75f", Role.GOOD: "#4ed07e", Role.CAUTION: "#ffb04d",
    Role.BAD: "#ff7575", Role.ON_BADGE: "#0b0e14", Role.ON_DANGER: "#ffffff", Role.ON_SELECTED: "#ffffff",
    Role.SKY: "#286ea5", Role.EARTH: "#875f2f", Role.REPLAY: "#b69cff",
}  # fmt: skip

_DARK_16 = {
    Role.PANEL: "#000000", Role.SELECTED: "#0000aa", Role.NOTE: "#000000", Role.DANGER: "#aa0000",
    Role.LINE: "#555555", Role.TEXT: "#aaaaaa", Role.DIM: "#aaaaaa", Role.MUTED: "#aaaaaa",
    Role.SKY: "#0000aa", Role.EARTH: "#000000", Role.REPLAY: "#ff55ff",
}  # fmt: skip

_LIGHT = {
    Role.BACKGROUND: "#ffffff", Role.PANEL: "#eef1f4", Role.SELECTED: "#dadcde", Role.NOTE: "#fff3d6",
    Role.DANGER: "#b3261e", Role.LINE: "#9aa4b0", Role.TEXT: "#24292f", Role.STRONG: "#000000", Role.DIM: "#57606a",
    Role.MUTED: "#4b535c", Role.INFO: "#0550ae", Role.KEY: "#5b21b6", Role.GOOD: "#116329", Role.CAUTION: "#6b4400",
    Role.BAD: "#b31d28", Role.ON_BADGE: "#ffffff", Role.ON_DANGER: "#ffffff", Role.ON_SELECTED: "#ffffff",
    Role.SKY: "#9cc9ee", Role.EARTH: "#b08850", Role.REPLAY: "#7c2d92",
}  # fmt: skip

_LIGHT_16 = {
    Role.PANEL: "#ffffff", Role.SELECTED: "#0000aa", Role.NOTE: "#ffffff", Role.DANGER: "#aa0000",
    Role.LINE: "#555555", Role.TEXT: "#000000", Role.DIM: "#000000", Role.MUTED: "#000000", Role.INFO: "#0000aa",
    Role.KEY: "#000000", Role.GOOD: "#0000aa", Role.CAUTION: "#aa00aa", Role.BAD: "#aa0000", Role.SKY: "#55ffff",
    Role.EARTH: "#ffffff", Role.REPLAY: "#aa00aa",
}  # fmt: skip

_HIGH_CONTRAST = {
    Role.BACKGROUND: "#000000", Role.PANEL: "#000000", Role.SELECTED: "#00005f", Role.NOTE: "#000000",
    Role.DANGER: "#870000", Role.LINE: "#ffffff", Role.TEXT: "#ffffff", Role.STRONG: "#ffffff", Role.DIM: "#d7d7d7",
    Role.MUTED: "#d7d7d7", Role.INFO: "#87d7ff", Role.KEY: "#ffff5f", Role.GOOD: "#5fff87", Role.CAUTION: "#ffaf5f",
    Role.BAD: "#ff8787", Role.ON_BADGE: "#000000", Role.ON_DANGER: "#ffffff", Role.ON_SELECTED: "#ffffff",
    Role.SKY: "#005faf", Role.EARTH: "#875f00", Role.REPLAY: "#ffafff",
}  # fmt: skip

_HIGH_CONTRAST_16 = {
    Role.SELECTED: "#0000aa", Role.DANGER: "#aa0000", Role.DIM: "#ffffff", Role.MUTED: "#ffffff", Role.INFO: "#55ffff",
    Role.GOOD: "#55ff55", Role.CAUTION: "#ffff55", Role.BAD: "#ff5555", Role.SKY: "#0000aa", Role.EARTH: "#000000",
    Role.REPLAY: "#ff55ff",
}  # fmt: skip

_COLOUR_BLIND = _DARK | {
    Role.DANGER: "#e6edf3", Role.ON_DANGER: "#0b0e14", Role.INFO: "#c0b8ff", Role.KEY: "#ffeeb0", Role.GOOD: "#56b4e9",
    Role.CAUTION: "#f0e442", Role.BAD: "#ff9e3d",
}  # fmt: skip
"""Blue and orange of Okabe and Ito (https://jfly.uni-koeln.de/color), whose difference everybody sees."""

_COLOUR_BLIND_16 = _DARK_16 | {
    Role.DANGER: "#ffffff", Role.ON_DANGER: "#000000", Role.INFO: "#aaaaaa", Role.KEY: "#ffffff", Role.GOOD: "#55ffff",
    Role.CAUTION: "#ffffff", Role.BAD: "#ffff55",
}  # fmt: skip

_GROUNDS = (
    Role.BACKGROUND,
    Role.PANEL,
    Role.SELECTED,
    Role.NOTE,
    Role.DANGER,
    Role.ON_BADGE,
    Role.SKY,
)

_NO_COLOUR = {role: "#000000" if role in _GROUNDS else "#ffffff" for role in Role}

THEMES: dict[ThemeName, ColourTheme] = {
    ThemeName.DARK: ColourTheme("Light text on a dark background", _DARK, _DARK_16),
    ThemeName.LIGHT: ColourTheme("Dark text on white, for daylight", _LIGHT, _LIGHT_16, dark=False),
    ThemeName.HIGH_CONTRAST: ColourTheme("White and bright colours on black", _HIGH_CONTRAST, _HIGH_CONTRAST_16),
    ThemeName.COLOUR_BLIND: ColourTheme("Blue and orange in place of green and red", _COLOUR_BLIND, _COLOUR_BLIND_16),
    ThemeName.NO_COLOUR: ColourTheme("Bold, reverse and underline only", _NO_COLOUR, attributes=True),
}


def choose_colours(name: ThemeName, *, sixteen: bool) -> Colours:
    """Return the colours of a theme for a terminal with 16 colours, or with more."""
    theme = THEMES[name]
    return {**theme.colours, **(theme.sixteen if sixteen else {})}


def build_textual_theme(name: ThemeName, *, sixteen: bool) -> Theme:
    """Return the theme for Textual: its own widgets and the variables of the style sheets."""
    colours = choose_colours(name, sixteen=sixteen)
    return Theme(
        name=name.value,
        primary=colours[Role.INFO],
        secondary=colours[Role.CAUTION],
        accent=colours[Role.KEY],
        foreground=colours[Role.TEXT],
        background=colours[Role.BACKGROUND],
        surface=colours[Role.BACKGROUND],
        panel=colours[Role.PANEL],
        success=colours[Role.GOOD],
        warning=colours[Role.CAUTION],
        error=colours[Role.BAD],
        dark=THEMES[name].dark,
        variables=css_variables(colours),
    )


def css_variables(colours: Colours) -> dict[str, str]:
    """Return the roles as variables, and those of Textual's own that it would blend from others."""
    own = {name: colours[role] for role, names in _TEXTUAL.items() for name in names}
    return {**{role.variable: colour for role, colour in colours.items()}, **own, **_REVERSE}


_REVERSE = {"block-cursor-text-style": "reverse", "block-cursor-blurred-text-style": "reverse"}
"""The chosen line of a list: readable with any colours, and without."""

_TEXTUAL = {
    Role.TEXT: ("block-cursor-foreground", "block-cursor-blurred-foreground"),
    Role.DIM: ("text-muted", "text-disabled", "foreground-muted"),
    Role.LINE: ("scrollbar", "scrollbar-hover", "scrollbar-active"),
    Role.PANEL: ("scrollbar-background", "scrollbar-background-hover", "scrollbar-background-active",
                 "scrollbar-corner-color", "block-cursor-background", "block-cursor-blurred-background"),
}  # fmt: skip
"""Role -> variables of Textual that have its colour."""
