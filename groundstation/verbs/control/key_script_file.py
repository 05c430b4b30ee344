"""Reads scripts of keys for `mavhelm drive`.

# time in s from the start, press or release, key
0.5 press i
2.5 release i
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence

from groundstation.actions import OperatorAction
from groundstation.formats.errors import FileFormatError, shown
from groundstation.input.keymap import KeyEvent, Keymap, KeymapError
from groundstation.input.keymap_file import parse_key
from groundstation.verbs.common.arguments import LONGEST_HOLD
from groundstation.verbs.control.key_script import KeyLine, can_play

MAX_LINES = 10_000


def parse_script(text: str, name: str, keymap: Keymap) -> tuple[KeyLine, ...]:
    """Return the lines of a script. Raises FileFormatError with the file `name` and the line."""
    lines: list[KeyLine] = []
    held: dict[str, int] = {}
    for number, words in _words(text):
        if len(lines) >= MAX_LINES:
            raise FileFormatError(f"{name}:{number}: more than {MAX_LINES} lines")
        try:
            line = _parse_line(words, number, keymap)
            _check_order(line, lines, held, keymap)
        except (FileFormatError, KeymapError) as error:
            raise FileFormatError(f"{name}:{number}: {error}") from error
        lines.append(line)
    if not lines:
        raise FileFormatError(f"{name}: no line such as '0.5 press i'")
    return tuple(lines)


def _words(text: str) -> Iterable[tuple[int, list[str]]]:
    """Yield the number and the words of each line that is not empty. # begins a comment, but as the third word."""
    for number, line in enumerate(text.splitlines(), 1):
        words = line.split()
        at = next((index for index, word in enumerate(words) if word.startswith("#") and index != 2), len(words))
        if words[:at]:
            yield number, words[:at]


def _parse_line(words: Sequence[str], number: int, keymap: Keymap) -> KeyLine:
    if len(words) != 3 or words[1] not in ("press", "release"):
        raise FileFormatError(f"{shown(' '.join(words))} is not TIME press|release KEY, e.g. 0.5 press i")
    try:
        at = float(words[0])
    except ValueError:
        at = math.nan
    if not (math.isfinite(at) and at >= 0):
        raise FileFormatError(f"{shown(words[0])} is not a time in s from the start")
    key = parse_key(words[2])
    if not can_play(keymap.in_flight().get_action(key)):
        _check_key(words[2], keymap.get_action(key), keymap)
    return KeyLine(at, KeyEvent(key, release=words[1] == "release"), number)


def _check_key(text: str, action: OperatorAction | None, keymap: Keymap) -> None:
    if action is None:
        raise FileFormatError(f"the key map {keymap.name} has no key {shown(text)}")
    if not can_play(action):
        raise FileFormatError(f"{shown(text)} is {action.label!r}, which a script cannot do")


def _check_order(line: KeyLine, before: Sequence[KeyLine], held: dict[str, int], keymap: Keymap) -> None:
    """Check a line against those before it; `held`: keys that are down, and the lines that pressed them."""
    key, earlier = line.event.key, before[-1].at if before else 0.0
    if line.at < earlier:
        raise FileFormatError(f"{line.at:g} s is before {earlier:g} s of line {before[-1].number}")
    driving = [each for each in held if (action := keymap.get_action(each)) and action.group == "drive"]
    if driving and line.at - earlier > LONGEST_HOLD:
        raise FileFormatError(
            f"{driving[0]} is held for more than {LONGEST_HOLD:g} s without another line; "
            "the vehicle would take it for a key that nobody operates"
        )
    if line.event.release and held.pop(key, None) is None:
        raise FileFormatError(f"{key} is not held")
    if not line.event.release and held.setdefault(key, line.number) != line.number:
        raise FileFormatError(f"{key} is held since line {held[key]}")
