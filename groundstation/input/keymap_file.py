"""Loads a key map by name or from a TOML file, and checks it."""

from __future__ import annotations

import difflib
import os
import re
from collections.abc import Mapping
from pathlib import Path

from groundstation.actions import ACTIONS
from groundstation.input.keymap import KEYMAPS, Keymap, KeymapError
from link.toml.file import TomlError, parse_toml, read_text

PUNCTUATION = {
    "!": "exclamation_mark", '"': "quotation_mark", "#": "number_sign", "$": "dollar_sign", "%": "percent_sign",
    "&": "ampersand", "'": "apostrophe", "(": "left_parenthesis", ")": "right_parenthesis", "*": "asterisk",
    "+": "plus", ",": "comma", "-": "minus", ".": "full_stop", "/": "slash", ":": "colon", ";": "semicolon",
    "<": "less_than_sign", "=": "equals_sign", ">": "greater_than_sign", "?": "question_mark", "@": "at",
    "[": "left_square_bracket", "\\": "backslash", "]": "right_square_bracket", "^": "circumflex_accent",
    "_": "underscore", "`": "grave_accent", "{": "left_curly_bracket", "|": "vertical_line",
    "}": "right_curly_bracket", "~": "tilde", " ": "space",
}  # fmt: skip
"""Character -> Textual's name of its key. A file may use either."""

NAMED_KEYS = frozenset(
    {
        "up",
        "down",
        "left",
        "right",
        "home",
        "end",
        "pageup",
        "pagedown",
        "insert",
        "delete",
        "backspace",
        "enter",
        "tab",
    }
    | {"escape", *PUNCTUATION.values()}
    | {f"f{number}" for number in range(1, 25)}
)

REQUIRED_ACTIONS = ("drive.stop", "stop.emergency", "app.quit")
"""Actions that need a key in every key map. Escape does not count: a plain terminal reports it 0.1 s late."""

MAX_SIZE = 256 * 1024
"""Bytes of a file that is read: far more than a key for each action needs."""

_MODIFIERS = re.compile(r"^(?:(?:ctrl|alt|shift|super)\+)+")


def load_keymap(name_or_path: str) -> Keymap:
    """Return the key map of a name in KEYMAPS or of a TOML file. Raises KeymapError."""
    if name_or_path in KEYMAPS:
        return Keymap(name_or_path, KEYMAPS[name_or_path])
    path = Path(os.path.expanduser(name_or_path))
    if path.suffix != ".toml" and not os.path.isfile(path):
        raise KeymapError(f"unknown key map {name_or_path!r}: choose {', '.join(KEYMAPS)} or the path of a .toml file")
    if not os.path.exists(path):
        raise KeymapError(f"key map {path}: no such file: name one of your own, or choose {', '.join(KEYMAPS)}")
    try:
        content = parse_toml(read_text(path, MAX_SIZE), str(path))
    except TomlError as error:
        raise KeymapError(f"key map {error}") from error
    return parse_keymap(content, path.stem, str(path))


def parse_keymap(content: Mapping[str, object], name: str, where: str) -> Keymap:
    """Return the key map that a TOML file's content describes. Raises KeymapError with `where` in its line."""
    try:
        unknown = set(content) - {"base", "keys"}
        if unknown:
            raise KeymapError(f"unknown entry {min(unknown)!r}: choose base, keys")
        base = content.get("base", "standard")
        if not isinstance(base, str) or base not in KEYMAPS:
            raise KeymapError(f"unknown base {base!r}: choose {', '.join(KEYMAPS)}")
        keys = content.get("keys", {})
        if not isinstance(keys, dict):
            raise KeymapError("'keys' must be a table")
        return rebind(Keymap(name, KEYMAPS[base]), keys)
    except KeymapError as error:
        raise KeymapError(f"key map {where}: {error}") from error


def rebind(base: Keymap, keys: Mapping[str, object]) -> Keymap:
    """Return the base map, in which each action of the table `keys` has the keys named there only.

    Raises KeymapError.
    """
    table = flatten(keys)
    bound = parse_bindings(table)
    kept = {key: action for key, action in base.bindings.items() if action not in table and key not in bound}
    bindings = kept | bound
    for action_id in REQUIRED_ACTIONS:
        if not {key for key, action in bindings.items() if action == action_id} - {"escape"}:
            raise KeymapError(f"{action_id} needs a key other than escape")
    return Keymap(base.name, bindings)


def flatten(keys: Mapping[str, object]) -> dict[str, object]:
    """Return action id -> keys. Without quotes TOML reads `drive.forward = "e"` as a table in a table."""
    flat: dict[str, object] = {}
    for name, value in keys.items():
        inside = {f"{name}.{inner}": each for inner, each in value.items()} if isinstance(value, dict) else {}
        flat |= inside or {name: value}
    return flat


def parse_bindings(keys: Mapping[str, object]) -> dict[str, str]:
    """Return key -> action id for everything that the flat table `keys` binds. Raises KeymapError."""
    bound: dict[str, str] = {}
    for action_id, value in keys.items():
        if action_id not in ACTIONS:
            raise KeymapError(f"unknown action {action_id!r}: {_suggest(action_id)}")
        for key in value if isinstance(value, list) else [value]:
            name = parse_key(key)
            if bound.setdefault(name, action_id) != action_id:
                raise KeymapError(f"key {key!r} is bound to {bound[name]} and to {action_id}")
    return bound


def _suggest(action_id: str) -> str:
    near = difflib.get_close_matches(action_id, ACTIONS, cutoff=0.8)
    return f"did you mean {near[0]}?" if near else f"choose {', '.join(ACTIONS)}"


def parse_key(key: object) -> str:
    """Return Textual's name of a key in any accepted spelling: "e", ",", "comma", "ctrl+x". Raises KeymapError."""
    if not isinstance(key, str) or not key:
        raise KeymapError(f"a key must be a string, not {key!r}")
    match = _MODIFIERS.match(key)
    modifiers = match.group() if match else ""
    plain = key[len(modifiers) :]
    plain = PUNCTUATION.get(plain, plain)
    if plain not in NAMED_KEYS and not (len(plain) == 1 and plain.isprintable()):
        raise KeymapError(
            f"unknown key {key!r}: choose a character, up, down, left, right, space, comma, "
            "full_stop, plus, minus, enter, tab, home, end, pageup, pagedown, insert, delete, backspace, "
            "f1 to f24, ctrl+..."
        )
    return modifiers + plain
