"""A sink that keeps what the key parser reports, and a clock that stands still."""

from __future__ import annotations

from collections.abc import Sequence

from groundstation.input.keymap import KeyEvent


class Sink:
    """Keeps the calls of the parser."""

    def __init__(self) -> None:
        self.batches: list[list[KeyEvent]] = []
        self.split: list[str] = []
        """Keys in the rest of split sequences."""
        self.told: list[str] = []
        self.cancelled = 0
        self.text = False
        """A text field has the keys."""

    def handle_keys(self, batch: Sequence[KeyEvent]) -> None:
        self.batches.append(list(batch))

    def handle_split_keys(self, batch: Sequence[KeyEvent]) -> None:
        self.split += [press.key for press in batch]

    def is_repeat(self, key: str) -> bool:
        return False

    def takes_text(self) -> bool:
        return self.text

    def handle_release_claim(self) -> None:
        self.told.append("claim")

    def handle_release_support(self) -> None:
        self.told.append("exact")

    def handle_plain_key(self) -> None:
        self.told.append("plain")

    def close(self, reason: str) -> None:
        self.told.append(f"shut: {reason}")

    def cancel_hold(self) -> None:
        self.cancelled += 1

    def handle_pong(self) -> None:
        self.told.append("pong")


class Clock:
    """A clock that is set by hand."""

    now = 100.0

    def __call__(self) -> float:
        return self.now
