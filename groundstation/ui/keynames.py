"""How keys are written on the screen: "," and not "comma"."""

from __future__ import annotations

from groundstation.keyfile import PUNCTUATION

_MARKS = {name: character for character, name in PUNCTUATION.items() if character != " "} | {
    "space": "SPACE", "tab": "TAB", "enter": "ENTER", "escape": "ESC", "up": "↑", "down": "↓", "left": "←",
    "right": "→", "pageup": "PgUp", "pagedown": "PgDn",
}  # fmt: skip


def key_name(key: str) -> str:
    """A key as people write it: "i", ",", "^q", "F9"."""
    *modifiers, last = key.split("+")
    shown = _MARKS.get(last) or (last.upper() if last[:1] == "f" and last[1:].isdigit() else last)
    return "".join("^" if modifier == "ctrl" else f"{modifier}+" for modifier in modifiers) + shown
