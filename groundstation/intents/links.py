"""Intents that open and close links. The station's shell handles them (groundstation/connect), not its core."""

from __future__ import annotations

from groundstation.intents.base import Intent


class AddLink(Intent, frozen=True):
    """Open a link; while that fails, it is tried again until the link is closed."""

    valid_when_late = True  # it moves nothing, and whoever asked waits for it
    request: int
    """Number by which ConnectView.attempts reports how it stands; see ui/display/request_numbers.py."""
    endpoint: str
    watch_only: bool = False
    """Never send a byte on it."""

    def describe(self) -> str:
        return f"open {self.endpoint}{' to watch only' if self.watch_only else ''}"


class CloseLink(Intent, frozen=True):
    """Close a link: neutral first to the vehicles that it leads to."""

    log_text = "close a link"
    link: int
    """LinkRow.index."""
