"""Navigation between the screens of the SCREENS table: at most one of them is open on top of the Drive screen."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from importlib import import_module
from typing import Any

from textual.app import App

from groundstation.screens import SCREENS, ScreenRow
from groundstation.ui.key_gate import OTHER_SCREEN, TEXT_FIELD, GateClosure
from groundstation.ui.screens.goto import BEFORE, GoToMenu
from groundstation.ui.screens.screen import ConsoleScreen, ScreenContext
from groundstation.views.base import ViewRequest

ROOT = SCREENS[0]
"""The Drive screen: always open, at the bottom."""


def find_row(name: str) -> ScreenRow:
    """Return the row of this id."""
    return next(row for row in SCREENS if row.id == name)


def load_screen(row: ScreenRow) -> type[ConsoleScreen]:
    """Import the class of a row."""
    module, _, name = row.target.partition(":")
    found: type[ConsoleScreen] = getattr(import_module(module), name)
    return found


class ScreenNavigator:
    """Opens and closes screens of an app."""

    def __init__(self, app: App[Any], context: ScreenContext) -> None:
        self._app, self._context = app, context
        self._current = self._before = ROOT

    @property
    def actions(self) -> dict[str, Callable[[], None]]:
        """Id of an action -> what it does."""
        return {
            "app.goto": self.open_menu,
            "app.next_screen": partial(self.open_neighbour, 1),
            "app.previous_screen": partial(self.open_neighbour, -1),
            **{row.action: partial(self.open, row) for row in SCREENS},
        }

    def open(self, row: ScreenRow) -> None:
        """Open a screen instead of the one on top of Drive. Several keys of one read may ask for the same one."""
        if row is not ROOT and any(isinstance(each, load_screen(row)) for each in self._app.screen_stack):
            return
        before = self._current
        self.go_back()
        if row is not ROOT:
            self._app.push_screen(load_screen(row)(self._context))
        if row is not before:
            self._current, self._before = row, before

    def open_before(self) -> None:
        """Open the screen that was shown before this one."""
        self.open(self._before)

    def open_neighbour(self, step: int) -> None:
        """Open the screen so many tabs to the right (or left); after the last tab comes the first."""
        tabs = [row for row in SCREENS if row.in_tabs]
        at = tabs.index(self._current) if self._current in tabs else 0
        self.open(tabs[(at + step) % len(tabs)])

    def open_menu(self) -> None:
        """Open the go-to menu; in it the key of the menu goes to the screen before."""
        if not isinstance(self._app.screen, GoToMenu):
            self._app.push_screen(GoToMenu(self._context), self._follow)

    def _follow(self, choice: str | None) -> None:
        if choice == BEFORE:
            self.open_before()
        elif choice:
            self.open(find_row(choice))

    def closure(self) -> GateClosure | None:
        """Return why what is on top keeps keys from driving; None on the Drive screen."""
        top = self._app.screen
        if isinstance(top, load_screen(ROOT)):
            return None
        text = top.takes_text if isinstance(top, ConsoleScreen) else not isinstance(top, GoToMenu)
        return TEXT_FIELD if text else OTHER_SCREEN

    @property
    def shown(self) -> ConsoleScreen | None:
        """The screen that is visible: the one on top, also under a menu or the palette."""
        screens = (each for each in reversed(self._app.screen_stack) if isinstance(each, ConsoleScreen))
        return next(screens, None)

    def requests(self) -> tuple[ViewRequest, ...]:
        """Return the views that the visible screen needs."""
        return self.shown.requests() if self.shown is not None else ()

    def go_back(self) -> None:
        """Close the screen on top of Drive. Anything else on top, such as the command palette, stays."""
        top = self._app.screen
        if isinstance(top, ConsoleScreen) and not isinstance(top, load_screen(ROOT)):
            self._app.pop_screen()
            self._current, self._before = ROOT, self._current
