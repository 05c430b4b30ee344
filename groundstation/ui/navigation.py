"""Navigation between the screens of the SCREENS table: at most one of them is open on top of the Drive screen."""

from __future__ import annotations

from importlib import import_module
from typing import Any

from textual.app import App

from groundstation.screens import SCREENS, ScreenRow
from groundstation.ui.screens.screen import ConsoleScreen, ScreenContext

ROOT = SCREENS[0]
"""The Drive screen: always open, at the bottom."""


def load_screen(row: ScreenRow) -> type[ConsoleScreen]:
    """Import the class of a row."""
    module, _, name = row.target.partition(":")
    found: type[ConsoleScreen] = getattr(import_module(module), name)
    return found


class ScreenNavigator:
    """Opens and closes screens of an app."""

    def __init__(self, app: App[Any], context: ScreenContext) -> None:
        self._app, self._context = app, context

    def open(self, row: ScreenRow) -> None:
        """Open a screen instead of the one on top of Drive. Several keys of one read may ask for the same one."""
        if row is ROOT:
            self.go_back()
            return
        kind = load_screen(row)
        if not any(isinstance(each, kind) for each in self._app.screen_stack):
            self.go_back()
            self._app.push_screen(kind(self._context))

    def go_back(self) -> None:
        """Close the screen on top of Drive. Anything else on top, such as the command palette, stays."""
        top = self._app.screen
        if isinstance(top, ConsoleScreen) and not isinstance(top, load_screen(ROOT)):
            self._app.pop_screen()
