"""Hint for a key that does nothing: because of Caps Lock, the layout or the screen, or because it arrived in pieces."""

from __future__ import annotations

import math

from groundstation.input.keymap import Keymap
from groundstation.ui.keys.keynames import format_key, main_key
from groundstation.ui.keys.mode_keys import MODE_KEYS

SPLIT_HINT = "a key arrived in pieces (slow line) and did nothing; stop keys work. ^g opens screens"

BURST_HINT = "several keys at once: ignored"

NOTED_FOR = 0.5
"""s for which the keys of such a read may follow it here."""

SHOWN_FOR = 5.0
"""s, as long as it takes to read."""


class KeyHint:
    """The hint for the last key."""

    def __init__(self, keymap: Keymap) -> None:
        self._keymap = keymap
        self._text: str | None = None
        self._until = -math.inf
        self._split = self._bursts = 0
        self._noted_at = -math.inf

    def press(self, key: str, now: float, keymap: Keymap | None = None) -> None:
        """Handle a key, by Textual's name. `keymap`: that of the vehicle, where it has another one."""
        self._keymap = keymap or self._keymap
        if now - self._noted_at < NOTED_FOR:
            return
        self._text = None if self._keymap.get_action(key) else self._explain(key)
        self._until = now + SHOWN_FOR

    def note_split(self, count: int, now: float) -> None:
        """Handle the number of keys that arrived in pieces so far."""
        if count != self._split:
            self._split, self._text, self._until = count, SPLIT_HINT, now + SHOWN_FOR

    def note_burst(self, count: int, now: float) -> None:
        """Handle the number of reads so far whose characters were too many to be keys."""
        if count != self._bursts:
            self._bursts, self._text, self._until, self._noted_at = count, BURST_HINT, now + SHOWN_FOR, now

    def text(self, now: float) -> str | None:
        """Return the hint while it is shown."""
        return self._text if now < self._until else None

    def _explain(self, key: str) -> str | None:
        if key in MODE_KEYS:
            opens = main_key(self._keymap, "app.map")
            return f"{key} is {MODE_KEYS[key][0]} on the Map" + (f" ({format_key(opens)})" if opens else "")
        if key == "tab":
            style = main_key(self._keymap, "drive.style")
            return "no panels to choose on this screen" + (f"; {format_key(style)}: drive style" if style else "")
        if len(key) != 1 or not key.isalpha():
            return None
        if not key.isascii():
            return f"{key} is not bound: switch to a Latin keyboard layout"
        action = self._keymap.get_action(key.swapcase())
        return f"{key} is not bound, {key.swapcase()} is {action.label}: is Caps Lock on?" if action else None
