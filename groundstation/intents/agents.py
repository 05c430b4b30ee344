"""Intents about the proposals of agents (station/agents/proposals.py)."""

from __future__ import annotations

from groundstation.intents.base import Intent


class PermitProposal(Intent, frozen=True):
    """The key that permits a proposal is held; sent again with each of its repeats."""

    number: int = 0
    """Of the proposal that was shown when the key went down."""
    held: float = 0.0
    """s for which the key was held; a proposal begins at HOLD_TIME."""


class EndPermission(Intent, frozen=True):
    """The key that permits a proposal was released, or does not count any more."""

    valid_when_late = True


class DeclineProposal(Intent, frozen=True):
    """Refuse the proposal that is shown, or end the one that runs."""

    log_text = "decline the proposal of the agent"
    valid_when_late = open_to_all = True
    number: int = 0
    """0: the one that is shown."""
