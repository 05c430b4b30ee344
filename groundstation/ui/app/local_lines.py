"""LOCAL_WORDS: what a line of the screens does without a vehicle: screens by name, themes, links, the filter, quit."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Protocol

from groundstation.config.settings import ThemeName
from groundstation.intents.links import AddLink
from groundstation.intents.union import AnyIntent
from groundstation.screens import SCREENS
from groundstation.ui.base.screen import ConsoleScreen
from link.endpoint import ANY_ADDRESSES, EndpointError, parse_endpoint


class LocalPart(Protocol):
    """What these words use of the app."""

    def open_screen(self, name: str) -> None:
        """Open the screen with this id."""

    def request_quit(self) -> None:
        """Quit as the key does."""

    def choose_theme(self, name: ThemeName) -> None:
        """Draw in another theme."""

    def send_intent(self, intent: AnyIntent) -> None:
        """Send an intent to the station."""

    def take_number(self) -> int:
        """Return the number of the next request."""

    @property
    def shown(self) -> ConsoleScreen | None:
        """The visible screen."""


Run = Callable[[LocalPart, list[str]], str | None]
"""Does it; takes the words behind the first one, and returns what is wrong with them, or None."""


def _quit(app: LocalPart, words: list[str]) -> None:
    app.request_quit()


def _set(app: LocalPart, words: list[str]) -> str | None:
    names = [each.value for each in ThemeName]
    if len(words) != 2 or words[0] != "theme" or words[1] not in names:
        return f"set theme {'|'.join(names)}; other settings are in the file of `mavhelm config`"
    app.choose_theme(ThemeName(words[1]))
    return None


def _open(name: str) -> Run:
    def run(app: LocalPart, words: list[str]) -> str | None:
        if words:
            return f"{name} opens the screen and takes no words"
        app.open_screen(name)
        return None

    return run


ACTS = ("drive", "log")
"""Screens that share their name with a verb of other meaning; without further words they are the screens."""

LOCAL_WORDS: Mapping[str, Run] = {
    "q": _quit, "quit": _quit, "set": _set,
    **{row.id: _open(row.id) for row in SCREENS if row.id not in ACTS},
    "vehicles": _open("links"), "status": _open("drive"), "doctor": _open("setup"),
}  # fmt: skip
"""First word -> what it does. They win over the verbs of the same names, which are screens here."""


def find_local(text: str) -> Callable[[LocalPart], str | None] | None:
    """Return what a line does here, or None if the station runs it."""
    words = text.split()
    if text.startswith("/"):
        return lambda app: _filter(app, text[1:].strip())
    if len(words) == 1 and words[0] in ACTS:
        return lambda app: app.open_screen(words[0])
    if words and words[0] in LOCAL_WORDS:
        return lambda app: LOCAL_WORDS[words[0]](app, words[1:])
    if len(words) == 1 and ":" in words[0] and not words[0].startswith("`"):
        return lambda app: _connect(app, words[0])
    return None


def complete_local(text: str) -> tuple[str, ...]:
    """Return the words here that may stand in place of the last one."""
    words = text.split(" ")
    if len(words) == 1:
        return tuple(word for word in LOCAL_WORDS if word.startswith(words[0]))
    choices = {("set",): ["theme"], ("set", "theme"): [each.value for each in ThemeName]}.get(tuple(words[:-1]), [])
    return tuple(word for word in choices if word.startswith(words[-1]))


def _filter(app: LocalPart, text: str) -> str | None:
    shown = app.shown
    return None if shown is not None and shown.filter_by(text) else "this screen has no filter"


def _connect(app: LocalPart, text: str) -> str | None:
    try:
        endpoint = parse_endpoint(text)
    except EndpointError as error:
        return str(error)
    if any(address in endpoint.text for address in ANY_ADDRESSES):
        return f"{text} listens to the whole network: Connect (^g c) asks first"
    app.send_intent(AddLink(request=app.take_number(), endpoint=endpoint.text))
    app.open_screen("connect")
    return None
