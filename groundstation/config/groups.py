"""Groups of vehicles, by system id and by name: what [groups] of the config file and `--group` may say. Sans-IO."""

from __future__ import annotations

import fnmatch
import re
from collections.abc import Sequence

import msgspec

LARGEST_ID = 255
SYNTAX = 'system ids, ranges and patterns of names with commas between them, as "1-20,31" or "*boat*"'
NAME = re.compile(r"[A-Za-z][A-Za-z0-9_.-]*")
"""Of a group; ids, ranges and patterns look different."""
WILD = re.compile(r"[*?\[]")
"""Of a pattern; a text without it is a name."""
_RANGE = re.compile(r"(\d{1,3})(?:-(\d{1,3}))?")
_PATTERN = re.compile(r"[^,]*[A-Za-z*?][^,]*")


class GroupError(Exception):
    """A text that names no vehicles; one line."""


class VehicleGroup(msgspec.Struct, frozen=True):
    """Which vehicles are meant."""

    listed: frozenset[int]
    """System ids that are named one by one: these vehicles must be heard."""
    others: frozenset[int]
    """System ids of ranges: of these, those that are heard."""
    patterns: tuple[str, ...]
    """Of names, in lower case, as "*boat*"."""

    @property
    def named(self) -> frozenset[str]:
        """The names that are written out, as "rover1", in lower case: these vehicles are waited for."""
        return frozenset(each for each in self.patterns if not WILD.search(each))

    def has(self, system: int, *names: str) -> bool:
        """Return whether a vehicle belongs to it. It has a name in its fleet, as "rover1", and one as "Rover 1"."""
        if system in self.listed or system in self.others:
            return True
        return any(fnmatch.fnmatchcase(name.lower(), each) for name in names for each in self.patterns)


EVERYBODY = VehicleGroup(frozenset(), frozenset(range(1, LARGEST_ID + 1)), ())


def parse_group(texts: str | Sequence[str]) -> VehicleGroup:
    """Parse one or more texts such as "1-20,31" and "*boat*". Raises GroupError."""
    listed: set[int] = set()
    others: set[int] = set()
    patterns: list[str] = []
    for part in _parts(texts):
        if found := _RANGE.fullmatch(part):
            first, last = int(found[1]), int(found[2] or found[1])
            if not 1 <= first <= last <= LARGEST_ID:
                raise GroupError(f"{part!r} is not a system id or a range of them: they go from 1 to {LARGEST_ID}")
            (others if found[2] else listed).update(range(first, last + 1))
        elif _PATTERN.fullmatch(part):
            patterns.append(part.lower())
        else:
            raise GroupError(f"{part!r} names no vehicles; write {SYNTAX}")
    return VehicleGroup(frozenset(listed), frozenset(others), tuple(patterns))


def _parts(texts: str | Sequence[str]) -> list[str]:
    return [part.strip() for text in ([texts] if isinstance(texts, str) else texts) for part in text.split(",")]
