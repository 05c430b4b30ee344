"""Hint for a letter that does nothing because of Caps Lock or the keyboard layout: few terminals report either."""

from __future__ import annotations

import math

from groundstation.input.keymap import Keymap

SHOWN_FOR = 5.0
"""s, as long as it takes to read."""


class KeyHint:
    """The hint for the last key."""

    def __init__(self, keymap: Keymap) -> None:
        self._keymap = keymap
        self._text: str | None = None
        self._until = -math.inf

    def press(self, key: str, now: float) -> None:
        """Handle a key, by Textual's name."""
        self._text = None if self._keymap.get_action(key) else self._explain(key)
        self._until = now + SHOWN_FOR

    def text(self, now: float) -> str | None:
        """Return the hint while it is shown."""
        return self._text if now < self._until else None

    def _explain(self, key: str) -> str | None:
        if len(key) != 1 or not key.isalpha():
            return None
        if not key.isascii():
            return f"{key} is not bound: switch to a Latin keyboard layout"
        action = self._keymap.get_action(key.swapcase())
        return f"{key} is not bound, {key.swapcase()} is {action.label}: is Caps Lock on?" if action else None
