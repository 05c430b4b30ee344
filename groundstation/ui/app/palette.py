"""Command palette: actions with their keys, modes and verbs of the `:` line, screens and themes, found by words."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from functools import partial

from textual.app import SystemCommand
from textual.command import DiscoveryHit, Hit, Hits, Provider

from groundstation.actions import ACTIONS, OperatorAction
from groundstation.config.settings import ThemeName
from groundstation.input.keymap import Keymap
from groundstation.intents.driving import DriveKeyDown
from groundstation.ui.keys.keynames import format_key
from groundstation.ui.look.themes import THEMES

STYLE = """
CommandPalette { background: transparent; }
CommandPalette > .command-palette--help-text { color: $dim; text-style: none; }
CommandPalette SearchIcon { display: none; }
"""
"""No veil, which would make ARMED hard to read, no dim help texts, and no icon of two cells."""

MODES_TEXT = "mode "
"""Line whose completions are the modes of the vehicle."""

LINES = {
    "home": "Drive home (RTL), after a question",
    "goto": "Drive to a latitude and longitude, after a question",
    "speed": "Set the speed at which the vehicle drives by itself",
    "stop": "Stop: HOLD, confirmed by the vehicle",
    "disarm": "Motors off, confirmed by the vehicle",
    "estop": "Emergency stop: motors off and locked",
    "mission start": "Start the mission, or go on with it, after a question",
    "mission pause": "Pause the mission where the vehicle is",
    "mission jump": "Go on with another item of the mission",
    "mission show": "List the mission in the log",
    "mission clear": "Delete the mission on the vehicle",
    "fence on": "Switch the fence on",
    "fence off": "Switch the fence off, after a question",
    "fence show": "List the fence in the log",
    "fence clear": "Delete the fence on the vehicle",
    "rally show": "List the rally points in the log",
    "rally clear": "Delete the rally points on the vehicle",
    "modes": "List the modes of the vehicle in the log",
    "param get": "Show parameters",
    "param set": "Set one parameter",
    "param store": "Have the vehicle store its parameters",
    "param reset": "Reset all parameters to their defaults",
    "request": "Request a message once",
    "rate": "Request a message at a rate",
    "command": "Send a MAVLink command",
    "control show": "Show who is in control",
    "control request": "Request control of the vehicle",
    "control release": "Release control of the vehicle",
    "reboot": "Restart the vehicle, after a question",
}
"""Verb of the `:` line -> its help. Choosing one writes it on the line; ENTER there runs it."""


def action_commands(keymap: Keymap, choose: Callable[[OperatorAction], None]) -> Iterator[SystemCommand]:
    """Yield a command for every action but those that mean holding a key, to drive or to confirm."""
    for action in ACTIONS.values():
        if not isinstance(action.intent, DriveKeyDown) and not action.confirm:
            keys = "  ".join(format_key(key) for key in _keys_of(action, keymap))
            yield SystemCommand(_title(action.label, keys), action.help, partial(choose, action))


def _keys_of(action: OperatorAction, keymap: Keymap) -> Iterator[str]:
    """Yield the keys of an action, and those that do it while armed, as the key of Arm disarms."""
    yield from keymap.get_keys(action.id)
    for other in ACTIONS.values():
        if other.when_armed is not None and other.when_armed == action.intent:
            yield from keymap.get_keys(other.id)


def line_commands(modes: Iterable[str], write: Callable[[str], None]) -> Iterator[SystemCommand]:
    """Yield a command for every mode of the vehicle and every verb, which `write` writes on the `:` line."""
    for mode in modes:
        yield SystemCommand(_title(f"Mode {mode}", f":{MODES_TEXT}{mode}"), "Change to this mode",
                            partial(write, f"{MODES_TEXT}{mode}"))  # fmt: skip
    for verb, text in LINES.items():
        yield SystemCommand(f":{verb}", text, partial(write, f"{verb} "))


def theme_commands(choose: Callable[[ThemeName], None]) -> Iterator[SystemCommand]:
    """Yield a command for every theme."""
    for name, theme in THEMES.items():
        yield SystemCommand(f"Theme {name}", theme.help, partial(choose, name))


def _title(label: str, keys: str) -> str:
    return f"{label}   {keys}" if keys else label


def rank(query: str, command: SystemCommand) -> float:
    """Return how well a command fits what is typed: 0 where a word of it is nowhere.

    A word counts where a word of the title or the help begins with it, or anywhere in the title; its letters are never
    looked for one by one: "rtl" is not "Release control".
    """
    title, text = command.title.lower(), command.help.lower()
    scores = [_rank_word(word, title, text) for word in query.lower().split()]
    return min(scores) + sum(scores) / 100 if scores and all(scores) else 0.0


def _rank_word(word: str, title: str, text: str) -> float:
    words = title.replace(":", " ").replace("_", " ").split()
    if word in words or word == title:
        return 1.0
    if any(each.startswith(word) for each in words):
        return 0.8
    if word in title:
        return 0.6
    return 0.4 if any(each.strip("(),.;").startswith(word) for each in text.split()) else 0.0


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
        """Yield those whose title or help has the words."""
        for command in self._commands:
            if (score := rank(query, command)) > 0:
                yield Hit(score, command.title, command.callback, text=command.title, help=command.help)
