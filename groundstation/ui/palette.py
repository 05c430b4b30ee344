"""The command palette's entries: every action of the table, by name."""

from __future__ import annotations

from functools import partial
from typing import Protocol, cast

from textual.command import DiscoveryHit, Hit, Hits, Provider

from groundstation.intents import ACTIONS, DriveKeyDown, OperatorAction


class ActionChooser(Protocol):
    """The app."""

    def choose_action(self, action: OperatorAction) -> None:
        """Do what was chosen."""


class ActionProvider(Provider):
    """All actions but the drive keys: driving is held, not chosen."""

    @property
    def _choices(self) -> list[OperatorAction]:
        return [action for action in ACTIONS.values() if not isinstance(action.intent, DriveKeyDown)]

    def _chosen(self, action: OperatorAction) -> partial[None]:
        return partial(cast(ActionChooser, self.app).choose_action, action)

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
