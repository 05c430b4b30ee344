"""The keys of the viewer, read by the same parser as those of the screens. No key drives here."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from groundstation.input.keymap import KeyEvent

QUIT = ("q", "escape", "ctrl+c", "ctrl+d", "ctrl+q")


class ViewerKeys:
    """Takes what the parser reads (groundstation/ui/terminal/key_parser.py: KeySink)."""

    def __init__(self, on_quit: Callable[[], None], on_pong: Callable[[], None]) -> None:
        self._on_quit, self._on_pong = on_quit, on_pong

    def handle_keys(self, batch: Sequence[KeyEvent]) -> None:
        """End the viewer at a key that does so."""
        if any(event.key in QUIT and not event.release for event in batch):
            self._on_quit()

    def handle_split_keys(self, batch: Sequence[KeyEvent]) -> None:
        """Handle nothing: there is nothing to stop."""

    def handle_release_claim(self) -> None:
        """Note nothing: no key is held here."""

    def handle_release_support(self) -> None:
        """Note nothing."""

    def handle_plain_key(self) -> None:
        """Note nothing."""

    def close(self, reason: str) -> None:
        """Go on without the focus: looking is no driving."""

    def handle_pong(self) -> None:
        """Note that the terminal has read the frame before the ping."""
        self._on_pong()

    def is_repeat(self, key: str) -> bool:
        """Return False: there are no repeats to leave out."""
        return False

    def takes_text(self) -> bool:
        """Return False: there is no text field."""
        return False

    def cancel_hold(self) -> None:
        """Handle nothing: the mouse does nothing here."""
