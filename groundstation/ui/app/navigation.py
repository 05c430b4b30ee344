"""Navigation between the screens of the SCREENS table: at most one of them is open on top of the Drive screen."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from importlib import import_module
from typing import Any

from textual.app import App
from textual.command import CommandPalette
from textual.screen import Screen

from groundstation.actions import ACTIONS
from groundstation.config.settings import ThemeName
from groundstation.intents.union import AnyIntent
from groundstation.screens import SCREENS, ScreenRow
from groundstation.ui.app.command_history import CommandHistory
from groundstation.ui.app.command_line import CommandLine
from groundstation.ui.app.goto import BEFORE, GoToMenu
from groundstation.ui.app.local_lines import find_local
from groundstation.ui.app.palette import MODES_TEXT
from groundstation.ui.base.screen import ConsoleScreen, ScreenContext
from groundstation.ui.keys.key_gate import OTHER_SCREEN, TEXT_FIELD, GateClosure
from groundstation.views.base import ViewRequest
from groundstation.views.line import DONE, FAILED, LineRequest, LineView

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

    def __init__(self, app: App[Any], context: ScreenContext, choose_theme: Callable[[ThemeName], None]) -> None:
        self._app, self._context, self._theme = app, context, choose_theme
        self._current = self._before = ROOT
        self._closing = 0
        self._held: ScreenRow | None = None
        self.modes: tuple[str, ...] = ()
        """Names of the modes of the vehicle, as the palette has last asked for them."""

    @property
    def actions(self) -> dict[str, Callable[[], None]]:
        """Id of an action -> what it does."""
        return {
            "app.goto": self.open_menu,
            "app.command": self.open_command,
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
        if row is not before:
            self._current, self._before = row, before
        if row is not ROOT:
            self._app.push_screen(load_screen(row)(self._context))

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

    def open_command(self, text: str = "") -> None:
        """Open the command line with a text on it."""
        if not isinstance(self._app.screen, CommandLine):
            self._app.push_screen(CommandLine(self._context, text), self._end_line)

    def _end_line(self, result: str | None) -> None:
        """Do what the line does here, or show how it has ended."""
        if result and result.startswith(":"):
            run = find_local(result[1:])
            result = run(self) if run is not None else None
        if result and self.shown is not None:
            self.shown.say(result)

    def show_line(self, view: LineView) -> None:
        """Show how a line stands: on the command line, else in the hint of the screen."""
        history = self._context.keep(CommandHistory)
        if view.text == MODES_TEXT and view.words:
            self.modes = tuple(word for word in view.words if not word.startswith("-"))
        if isinstance(self._app.screen, CommandLine):
            self._app.screen.show_view(view)
        elif view.number == history.number != history.told and view.state in (DONE, FAILED):
            history.told = view.number
            if self.shown is not None:
                self.shown.say(view.note)

    def open_screen(self, name: str) -> None:
        """Open the screen with this id."""
        self.open(find_row(name))

    def request_quit(self) -> None:
        """Quit as the key does."""
        self._context.perform(ACTIONS["app.quit"])

    def choose_theme(self, name: ThemeName) -> None:
        """Draw in another theme."""
        self._theme(name)

    def send_intent(self, intent: AnyIntent) -> None:
        """Send an intent to the station."""
        self._context.send(intent)

    def take_number(self) -> int:
        """Return the number of the next request."""
        return self._context.numbers.take()

    def open_menu_at_once(self) -> bool:
        """Open the menu before a widget sees its key, so that the digit behind it in one read is the menu's.

        Return False where the key belongs to what is on top: the menu itself, the palette, a text field.
        """
        top = self._app.screen
        if not isinstance(top, ConsoleScreen) or top.takes_text:
            return False
        self.open_menu()
        return True

    def open_command_at_once(self, key: str) -> bool:
        """Open the command line before a widget sees its key, so that the text behind it in one read is the line's.

        Return False where the key belongs to what is on top, as for open_menu_at_once, or the screen has a use for it.
        """
        top = self._app.screen
        if not isinstance(top, ConsoleScreen) or top.takes_text or top.question is not None or top.uses(key):
            return False
        self.open_command()
        return True

    def _follow(self, choice: str | None) -> None:
        if choice == BEFORE:
            self.open_before()
        elif choice:
            self.open(find_row(choice))

    def note_popped(self, screen: Screen[Any]) -> None:
        """Keep keys from the screen below a menu, line or palette until what was chosen in it has been done.

        Else a digit typed behind the choice could change the mode on a screen that the operator has left.
        """
        if isinstance(screen, ConsoleScreen):
            return
        self._closing += 1
        self._app.call_later(
            self._app.call_later, self._end_closing
        )  # twice: the palette queues its command after this

    def _end_closing(self) -> None:
        self._closing -= 1
        if not self._closing and self._held is not None:
            row, self._held = self._held, None
            self.open(row)

    def hold(self, action: str) -> None:
        """Open the screen of an action as soon as what was chosen has been done; other keys are dropped meanwhile."""
        self._held = next((row for row in SCREENS if row.action == action), self._held)

    @property
    def closing(self) -> bool:
        """A menu, line or palette has closed, and what was chosen in it has not been done yet."""
        return self._closing > 0

    def closure(self) -> GateClosure | None:
        """Return why what is on top keeps keys from driving; None on the Drive screen."""
        top = self._app.screen
        if isinstance(top, load_screen(ROOT)):
            return OTHER_SCREEN if self.closing else None
        text = top.takes_text if isinstance(top, (ConsoleScreen, CommandLine)) else not isinstance(top, GoToMenu)
        if text:
            return TEXT_FIELD
        keys = top.agent_keys if isinstance(top, ConsoleScreen) and not self.closing else frozenset()
        return GateClosure(OTHER_SCREEN.reason, OTHER_SCREEN.level, keys) if keys else OTHER_SCREEN

    @property
    def shown(self) -> ConsoleScreen | None:
        """The screen that is visible: the one on top, also under a menu or the palette."""
        screens = (each for each in reversed(self._app.screen_stack) if isinstance(each, ConsoleScreen))
        return next(screens, None)

    @property
    def current(self) -> str:
        """Id of that screen."""
        return self._current.id

    @property
    def before(self) -> ScreenRow:
        """The screen that was shown before that one."""
        return self._before

    def requests(self) -> tuple[ViewRequest, ...]:
        """Return the views that the visible screen needs."""
        views = self.shown.requests() if self.shown is not None else ()
        history = self._context.keep(CommandHistory)
        if isinstance(self._app.screen, CommandLine):
            return (*views, self._app.screen.request)
        if isinstance(self._app.screen, CommandPalette):
            vehicle = self._context.newest().snapshot.vehicle
            return (*views, LineRequest(history.number, MODES_TEXT, 0 if vehicle is None else vehicle.system))
        return (*views, LineRequest(history.number)) if history.number != history.told else views

    def go_back(self) -> None:
        """Close the screen on top of Drive. Anything else on top, such as the command palette, stays."""
        top = self._app.screen
        if isinstance(top, ConsoleScreen) and not isinstance(top, load_screen(ROOT)):
            self._app.pop_screen()
            self._current, self._before = ROOT, self._current
