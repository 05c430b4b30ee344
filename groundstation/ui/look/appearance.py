"""Appearance: how the app draws, whatever it shows. The theme, ASCII, and whether anything moves by itself."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

import msgspec
from textual.app import App
from textual.filter import LineFilter, Monochrome
from textual.screen import Screen
from textual.widgets import Input

from groundstation.config.settings import ThemeName
from groundstation.ui.look.ascii import AsciiFilter
from groundstation.ui.look.colours import use_theme
from groundstation.ui.look.no_colour import NoColourFilter
from groundstation.ui.look.themes import THEMES, build_textual_theme


class Look(msgspec.Struct, frozen=True):
    """What the user has chosen."""

    theme: ThemeName = ThemeName.DARK
    ascii: bool = False
    """ASCII characters only."""
    reduce_motion: bool = False
    """Nothing moves by itself."""


PLAIN = Look()


class Appearance:
    """Applies a Look to an app."""

    def __init__(self, app: App[Any], look: Look) -> None:
        self.look = look
        self._app = app
        self._ascii = AsciiFilter(enabled=look.ascii)
        self._no_colour = NoColourFilter(enabled=False)
        if look.reduce_motion:
            app.animation_level = "none"
        self.apply_theme(look.theme)

    def apply_theme(self, name: ThemeName) -> None:
        """Draw in this theme from now on, with the colours that the terminal has."""
        sixteen = self._app.console.color_system == "standard"
        use_theme(name, sixteen=sixteen)
        self._no_colour.enabled = THEMES[name].attributes
        self._app.register_theme(build_textual_theme(name, sixteen=sixteen))
        self._app.theme = name.value

    def choose_theme(self, name: ThemeName) -> None:
        """Draw everything that is shown in another theme."""
        self.apply_theme(name)
        for screen in self._app.screen_stack:
            for widget in screen.walk_children(with_self=True):
                widget.refresh()

    def settle(self, screen: Screen[Any]) -> None:
        """Keep the cursors of a screen that is opened from blinking, if nothing shall move."""
        if self.look.reduce_motion:
            screen.call_after_refresh(_stop_blinking, screen)

    def filters(self, inherited: Iterable[LineFilter]) -> Sequence[LineFilter]:
        """Return the filters of all that is drawn. That of Textual for NO_COLOR would leave greys."""
        own = (each for each in (self._no_colour, self._ascii) if each.enabled)
        return [*(each for each in inherited if not isinstance(each, Monochrome)), *own]


def _stop_blinking(screen: Screen[Any]) -> None:
    for field in screen.query(Input):
        field.cursor_blink = False
