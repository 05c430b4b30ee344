"""The smallest Textual program, as the reference for what Textual itself costs."""

from __future__ import annotations

from textual.app import App, ComposeResult
from textual.widgets import Static


class Bare(App[None]):
    """One line of text."""

    def compose(self) -> ComposeResult:
        """The line."""
        yield Static("bare textual ready")


if __name__ == "__main__":
    Bare().run()
