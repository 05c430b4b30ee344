"""Loads a key map by name or from a TOML file, and checks it."""

from __future__ import annotations

import os
import re
from collections.abc import Mapping, Set
from pathlib import Path

from groundstation.actions import ACTIONS
from groundstation.input.keymap import KEYMAPS, Keymap, KeymapError
from link.runtime.toml_file import TomlError, read_toml

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

_MODIFIERS = re.compile(r"^(?:(?:ctrl|alt|shift|super)\+)+")


def load_keymap(name_or_path: str) -> Keymap:
    """Return the key map of a name in KEYMAPS or of a TOML file. Raises KeymapError."""
    if name_or_path in KEYMAPS:
        return Keymap(name_or_path, KEYMAPS[name_or_path])
    path = Path(os.path.expanduser(name_or_path))
    if path.suffix != ".toml" and not os.path.isfile(path):
        raise KeymapError(f"unknown key map {name_or_path!r}: choose {', '.join(KEYMAPS)} or the path of a .toml file")
    try:
        content = read_toml(path)
    except TomlError as error:
        raise KeymapError(f"key map {error}") from error
    return parse_keymap(content, path.stem, str(path))


def parse_keymap(content: Mapping[str, object], name: str, where: str) -> Keymap:
    """Return the key map that a TOML file's content describes. Raises KeymapError with `where` in its line."""
    unknown = set(content) - {"base", "keys"}
    if unknown:
        raise KeymapError(f"key map {where}: unknown entry {min(unknown)!r}: choose base, keys")
    base = content.get("base", "standard")
    if not isinstance(base, str) or base not in KEYMAPS:
        raise KeymapError(f"key map {where}: unknown base {base!r}: choose {', '.join(KEYMAPS)}")
    keys = content.get("keys", {})
    if not isinstance(keys, dict):
        raise KeymapError(f"key map {where}: 'keys' must be a table")
    bindings = _rebind(KEYMAPS[base], _parse_keys(keys, where), changed=set(keys))
    _check(bindings, where)
    return Keymap(name, bindings)


def _parse_keys(keys: Mapping[str, object], where: str) -> dict[str, str]:
    """Return key -> action id for everything that the file binds."""
    bound: dict[str, str] = {}
    for action_id, value in keys.items():
        if action_id not in ACTIONS:
            raise KeymapError(f"key map {where}: unknown action {action_id!r}: choose {', '.join(ACTIONS)}")
        for key in value if isinstance(value, list) else [value]:
            name = parse_key(key, where)
            if bound.setdefault(name, action_id) != action_id:
                raise KeymapError(f"key map {where}: key {key!r} is bound to {bound[name]} and to {action_id}")
    return bound


def _rebind(base: Mapping[str, str], bound: Mapping[str, str], changed: Set[str]) -> dict[str, str]:
    """Return the base map, in which each action in `changed` has the keys of `bound` only."""
    kept = {key: action_id for key, action_id in base.items() if action_id not in changed and key not in bound}
    return kept | dict(bound)


def parse_key(key: object, where: str) -> str:
    """Return Textual's name of a key in any accepted spelling: "e", ",", "comma", "ctrl+x". Raises KeymapError."""
    if not isinstance(key, str) or not key:
        raise KeymapError(f"key map {where}: a key must be a string, not {key!r}")
    match = _MODIFIERS.match(key)
    modifiers = match.group() if match and len(match.group()) < len(key) else ""
    plain = key[len(modifiers) :]
    plain = PUNCTUATION.get(plain, plain)
    if plain not in NAMED_KEYS and not (len(plain) == 1 and plain.isprintable()):
        raise KeymapError(
            f"key map {where}: unknown key {key!r}: choose a character, up, down, left, right, space, comma, "
            "full_stop, plus, minus, enter, tab, home, end, pageup, pagedown, insert, delete, backspace, "
            "f1 to f24, ctrl+..."
        )
    return modifiers + plain


def _check(bindings: Mapping[str, str], where: str) -> None:
    for action_id in REQUIRED_ACTIONS:
        keys = {key for key, bound in bindings.items() if bound == action_id}
        if not keys - {"escape"}:
            raise KeymapError(f"key map {where}: {action_id} needs a key other than escape")
