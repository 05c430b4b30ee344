"""Command palette: every action but the drive keys, found by label or help text."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial

from textual.app import SystemCommand
from textual.command import DiscoveryHit, Hit, Hits, Provider

from groundstation.actions import ACTIONS, OperatorAction
from groundstation.config.settings import ThemeName
from groundstation.intents.driving import DriveKeyDown
from groundstation.ui.look.themes import THEMES

STYLE = """
CommandPalette { background: transparent; }
CommandPalette > .command-palette--help-text { color: $dim; text-style: none; }
CommandPalette SearchIcon { display: none; }
"""
"""No veil, which would make ARMED hard to read, no dim help texts, and no icon of two cells."""


def action_commands(choose: Callable[[OperatorAction], None]) -> Iterator[SystemCommand]:
    """Yield a command for every action but those that mean holding a key, to drive or to confirm."""
    for action in ACTIONS.values():
        if not isinstance(action.intent, DriveKeyDown) and not action.confirm:
            yield SystemCommand(action.label, action.help, partial(choose, action))


def theme_commands(choose: Callable[[ThemeName], None]) -> Iterator[SystemCommand]:
    """Yield a command for every theme."""
    for name, theme in THEMES.items():
        yield SystemCommand(f"Theme {name}", theme.help, partial(choose, name))


class ActionProvider(Provider):
    """The app's commands, see ConsoleApp.get_system_commands. The stock provider searches labels only."""

    @property
    def _commands(self) -> list[SystemCommand]:
        return list(self.app.get_system_commands(self.screen))

    async def discover(self) -> Hits:
        """Yield all of them, before anything is typed."""
        for command in self._commands:
            yield DiscoveryHit(command.title, command.callback, help=command.help)

    async def search(self, query: str) -> Hits:
        """Yield those whose label or help matches the text."""
        matcher = self.matcher(query)
        for command in self._commands:
            score = max(matcher.match(command.title), matcher.match(command.help) / 2)
            if score > 0:
                yield Hit(score, matcher.highlight(command.title), command.callback, help=command.help)
