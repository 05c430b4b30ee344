"""Filter and order of the Messages screen."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Sequence

from groundstation.natural_order import natural_key
from groundstation.station.messages.fuzzy import is_match
from groundstation.views.messages import MessageRow

_NUMBER = re.compile(r"(?P<what>|age)(?P<sign>[<>])(?P<limit>\d+(?:\.\d+)?)(?:hz|s)?")

Matches = Callable[[MessageRow, Sequence[str]], bool]
"""Tells whether a row with these field names is shown."""

SORT_KEYS: dict[str, Callable[[MessageRow], tuple[float, tuple[str | int, ...]]]] = {
    "name": lambda row: (0.0, natural_key(row.name)),
    "rate": lambda row: (-row.rate, natural_key(row.name)),
    "bytes": lambda row: (-row.bytes, natural_key(row.name)),
    "age": lambda row: (row.age, natural_key(row.name)),
}
"""Order -> sort key; "source" is the order of the table itself."""


def parse_filter(text: str) -> Matches:
    """Return a filter. All of its words must match.

    A word is a part of a message's name or pieces of its words (fuzzy.py), or ">5Hz", "<1Hz", "age>3" (s), "src:1" or
    "src:1/1", "field:volt" (the same for the name of a field), "sent", "lost" (of a source that has lost frames).
    """
    tests = [_parse_word(word) for word in text.lower().split()]
    return lambda row, fields: all(test(row, fields) for test in tests)


def sorted_rows(rows: Iterable[MessageRow], order: str) -> list[MessageRow]:
    """Return rows in an order other than "source"."""
    return sorted(rows, key=SORT_KEYS[order])


def _parse_word(word: str) -> Matches:
    if number := _NUMBER.fullmatch(word):
        limit, above, age = float(number["limit"]), number["sign"] == ">", number["what"] == "age"
        return lambda row, _: ((row.age if age else row.rate) > limit) == above
    if word == "sent":
        return lambda row, _: row.sent
    if word == "lost":
        return lambda row, _: row.lost > 0
    if word.startswith("src:"):
        system, _, component = word.removeprefix("src:").partition("/")
        return lambda row, _: str(row.system) == system and component in ("", str(row.component))
    if word.startswith("field:"):
        part = word.removeprefix("field:")
        return lambda _, fields: any(is_match(part, field) for field in fields)
    return lambda row, _: is_match(word, row.name)
