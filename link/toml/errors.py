"""Rewords msgspec's validation errors for the user: key, error, remedy."""

from __future__ import annotations

import copy
import re
from collections.abc import Callable, Iterable
from typing import Any

import msgspec
from msgspec import inspect

KINDS = {
    "int": "a whole number",
    "float": "a number",
    "str": 'text in "quotes"',
    "bool": "true or false",
    "array": "a list in [brackets]",
    "object": "a table",
}
"""msgspec's name of a type -> what to write in TOML."""
BOUNDS = {">=": "at least", "<=": "at most", ">": "more than", "<": "less than"}


def suggest(word: str, known: Iterable[str], otherwise: str = "") -> str:
    """Return "did you mean ...?", or `otherwise`, or the known words."""
    known = list(known)
    import difflib  # when it is needed: it takes 1 ms of each start

    near = difflib.get_close_matches(word, known, n=2, cutoff=0.6)
    if near:
        return f"did you mean {' or '.join(near)}?"
    return otherwise or f"there {'is only' if len(known) == 1 else 'are'} {', '.join(known)}"


def explain_error(error: msgspec.ValidationError, kind: Any, at: str, also: Iterable[str] = ()) -> str:
    """Return one line. `kind`: expected type; `at`: key of the table; `also`: more keys it may have."""
    what, _, path = str(error).partition(" - at `$")
    path = path.removesuffix("`")
    for pattern, reword in _REWORDINGS.items():
        found = re.fullmatch(pattern, what)
        if found:
            path, what = reword(found, _Place(kind, path, tuple(also)))
            break
    return f"{_joined(at, path)}: {what}"


def explain_errors(table: Any, kind: Any, at: str, also: Iterable[str] = ()) -> list[str]:
    """Return one line for each mistake in a table; [] for none. The arguments are those of `explain_error`.

    msgspec names the first mistake only, so what it names is left out and the rest is tried again.
    """
    found: list[str] = []
    also, rest, dropped = tuple(also), copy.deepcopy(table), set[str]()
    while True:
        try:
            msgspec.convert(rest, kind)
        except msgspec.ValidationError as error:
            line = explain_error(error, kind, at, also)
            if line.partition(": ")[0] not in dropped:  # else it is missing because its mistake was named
                found.append(line)
            key = _drop(rest, error)
            if key is None:
                return found
            dropped.add(_joined(at, key))
        else:
            return found


def _drop(table: Any, error: msgspec.ValidationError) -> str | None:
    """Remove what an error names from a table; return its path, None where nothing is left to be removed.

    Of a list all goes, because the numbers of its entries are part of the paths; a table that lacks a key goes as well.
    """
    what, _, path = str(error).partition(" - at `$")
    path, is_in_list, _ = path.removesuffix("`").partition("[")
    steps = path.split(".")[1:]
    if not is_in_list and (unknown := re.fullmatch(r"Object contains unknown field `(.+)`", what)):
        steps.append(unknown[1])
    if not steps:
        return None
    for step in steps[:-1]:
        table = table[step]
    del table[steps[-1]]
    return "." + ".".join(steps)


class _Place:
    """A position in the table, and what the types allow there."""

    def __init__(self, kind: Any, path: str, also: tuple[str, ...]) -> None:
        self.path = path
        self._root = inspect.type_info(kind)
        self._also = also

    def keys(self) -> list[str]:
        """Return the keys of the table here."""
        structs = [each for each in self._walk(self._steps()) if isinstance(each, inspect.StructType)]
        names = [name for struct in structs for name in _keys(struct)]
        return list(dict.fromkeys(names + ([] if self._steps() else list(self._also))))

    def choices(self, key: str | None = None) -> list[str]:
        """Return the allowed values here, or at `key` here, where they can be listed."""
        steps = self._steps() if key is None else [*self._steps(), key]
        parents = [each for each in self._walk(steps[:-1]) if isinstance(each, inspect.StructType)]
        tags = [str(each.tag) for each in parents if each.tag_field == steps[-1]]
        here = [each for each in self._walk(steps) if isinstance(each, inspect.LiteralType)]
        return tags or [str(value) for each in here for value in each.values]

    def _steps(self) -> list[str]:
        return re.findall(r"[^.\[\]]+", self.path)

    def _walk(self, steps: list[str]) -> list[inspect.Type]:
        types = _alternatives(self._root)
        for step in steps:
            types = [deeper for each in types for deeper in _deeper(each, step)]
        return types


def _alternatives(kind: inspect.Type) -> list[inspect.Type]:
    if isinstance(kind, inspect.Metadata):
        return _alternatives(kind.type)
    if isinstance(kind, inspect.UnionType):
        return [each for part in kind.types for each in _alternatives(part)]
    return [kind]


def _deeper(kind: inspect.Type, step: str) -> list[inspect.Type]:
    if isinstance(kind, inspect.StructType):
        return [each for field in kind.fields if field.encode_name == step for each in _alternatives(field.type)]
    return _alternatives(kind.item_type) if isinstance(kind, inspect.CollectionType) else []


def _keys(struct: inspect.StructType) -> list[str]:
    return ([struct.tag_field] if struct.tag_field else []) + [field.encode_name for field in struct.fields]


def _unknown(found: re.Match[str], place: _Place) -> tuple[str, str]:
    return f"{place.path}.{found[1]}", f"unknown key; {suggest(found[1], place.keys())}"


def _missing(found: re.Match[str], place: _Place) -> tuple[str, str]:
    choices = place.choices(found[1])
    return f"{place.path}.{found[1]}", f"missing; add it{', one of ' + ', '.join(choices) if choices else ''}"


def _mistaken(found: re.Match[str], place: _Place) -> tuple[str, str]:
    wanted = next((KINDS[each] for each in found[1].split(" | ") if each in KINDS), found[1])
    return place.path, f"must be {wanted}, not {KINDS.get(found[2], found[2])}"


def _outside(found: re.Match[str], place: _Place) -> tuple[str, str]:
    return place.path, f"must be {BOUNDS[found[1]]} {found[2]}"


def _counted(found: re.Match[str], place: _Place) -> tuple[str, str]:
    return place.path, f"must have {BOUNDS[found[1]]} {found[2]} {'entry' if found[2] == '1' else 'entries'}"


def _unlisted(found: re.Match[str], place: _Place) -> tuple[str, str]:
    return place.path, f"{found[1]} is not known; {suggest(found[1].strip(chr(39)), place.choices())}"


_REWORDINGS: dict[str, Callable[[re.Match[str], _Place], tuple[str, str]]] = {
    r"Object contains unknown field `(.+)`": _unknown,
    r"Object missing required field `(.+)`": _missing,
    r"Expected `(.+)`, got `(.+)`": _mistaken,
    r"Expected `[^`]+` ([<>]=?) (\S+)": _outside,
    r"Expected `[^`]+` of length ([<>]=?) (\d+)": _counted,
    r"Invalid (?:enum )?value (.+)": _unlisted,
}
"""msgspec's message -> position and text. Other messages, e.g. of a ValueError in __post_init__, stay as they are."""


def _joined(at: str, path: str) -> str:
    return (at + path).lstrip(".") or "the file"
