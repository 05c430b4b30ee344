"""The command palette's entries: every action of the table, by name."""

from __future__ import annotations

from functools import partial
from typing import Protocol, cast

from textual.command import DiscoveryHit, Hit, Hits, Provider

from groundstation.input.keymap import ACTIONS, Action
from groundstation.intents import Push


class Chooser(Protocol):
    """The app."""

    def choose(self, action: Action) -> None:
        """Do what was chosen."""


class Actions(Provider):
    """All actions but the drive keys: driving is held, not chosen."""

    @property
    def _choices(self) -> list[Action]:
        return [action for action in ACTIONS.values() if not isinstance(action.intent, Push)]

    def _chosen(self, action: Action) -> partial[None]:
        return partial(cast(Chooser, self.app).choose, action)

    async def discover(self) -> Hits:
        """All of them, before anything is typed."""
        for action in self._choices:
            yield DiscoveryHit(action.label, self._chosen(action), help=action.help)

    async def search(self, query: str) -> Hits:
        """Those whose name or help is like the text."""
        matcher = self.matcher(query)
        for action in self._choices:
            score = max(matcher.match(action.label), matcher.match(action.help) / 2)
            if score > 0:
                yield Hit(score, matcher.highlight(action.label), self._chosen(action), help=action.help)
