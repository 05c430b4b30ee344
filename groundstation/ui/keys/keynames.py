"""Names of keys as printed on the screen: "," instead of "comma"."""

from __future__ import annotations

from groundstation.input.keymap import Keymap
from groundstation.input.keymap_file import PUNCTUATION
from groundstation.input.pad_mapping import BUTTONS, KEY_PREFIX

_MARKS = {name: character for character, name in PUNCTUATION.items() if character != " "} | {
    "space": "SPACE", "tab": "TAB", "enter": "ENTER", "escape": "ESC", "up": "↑", "down": "↓", "left": "←",
    "right": "→", "pageup": "PgUp", "pagedown": "PgDn",
}  # fmt: skip

_PLACES = frozenset({"u", "i", "o", "j", "k", "l", "m", "comma", "full_stop"})


def format_key(key: str) -> str:
    """Return a key as it is commonly written: "i", ",", "^q", "F9"."""
    if key.startswith(KEY_PREFIX):
        return f"pad {BUTTONS[key.removeprefix(KEY_PREFIX)]}"
    *modifiers, last = key.split("+")
    shown = _MARKS.get(last) or (last.upper() if last[:1] == "f" and last[1:].isdigit() else last)
    return "".join("^" if modifier == "ctrl" else f"{modifier}+" for modifier in modifiers) + shown


def main_key(keymap: Keymap, action_id: str) -> str | None:
    """Return the key to print for an action that has several: a letter or mark, as on a key cap.

    Keys around `k` are preferred, so that the caps look like the block on the keyboard.
    """
    keys = keymap.get_keys(action_id)
    place = [key for key in keys if key in _PLACES]
    short = [key for key in keys if len(format_key(key)) == 1 and key.isascii()]
    return next(iter((*place, *short, *keys)), None)


def is_character(key: str) -> bool:
    """Return whether a key types a character into a text field."""
    return len(key) == 1 or key in PUNCTUATION.values()
