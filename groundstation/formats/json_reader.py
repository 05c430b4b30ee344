"""Reads a JSON object field by field; each error names the file and the field."""

from __future__ import annotations

import json
from typing import Any, NoReturn, TypeVar

import msgspec

from groundstation.formats.errors import FileFormatError
from groundstation.geo import MAX_LATITUDE, place_fault
from link.services.param.float32 import is_float32

T = TypeVar("T")
_NAMES: dict[type, str] = {str: "a text", bool: "true or false", dict: "an object", list: "a list"}


def load_object(text: str, source: str, kind: str, *, constants: bool = False) -> dict[str, Any]:
    """Return the object of a file of this kind. Raises FileFormatError.

    `kind`: for messages, e.g. "a plan". `constants`: NaN and Infinity are read, for a reader that names where they are;
    else they are refused.
    """

    def refuse(constant: str) -> NoReturn:
        raise FileFormatError(f"{source}: {constant} is not a number of JSON")

    try:
        value = json.loads(text.removeprefix("\ufeff"), parse_constant=float if constants else refuse)
    except FileFormatError:
        raise
    except json.JSONDecodeError as error:
        raise FileFormatError(f"{source}:{error.lineno}: this is not JSON: {error.msg}") from None
    except (RecursionError, ValueError):
        raise FileFormatError(f"{source}: this is not {kind}: nested too deeply, or a number too long") from None
    if not isinstance(value, dict):
        raise FileFormatError(f"{source}: this is not {kind}: it is not a JSON object")
    return value


class JsonReader(msgspec.Struct, frozen=True):
    """An object of a file; `where` is the file and the path to the object."""

    value: dict[str, Any]
    where: str

    def fail(self, text: str) -> NoReturn:
        """Raise FileFormatError."""
        raise FileFormatError(f"{self.where}: {text}")

    def get(self, name: str, kind: type[T]) -> T:
        """Return a field of this type."""
        if name not in self.value:
            self.fail(f'"{name}" is missing')
        found = self.value[name]
        if not isinstance(found, kind):
            self.fail(f'"{name}" is not {_NAMES[kind]}')
        return found

    def at(self, name: str) -> JsonReader:
        """Return an object inside this one."""
        return JsonReader(self.get(name, dict), f"{self.where}: {name}")

    def items(self, name: str, limit: int) -> list[JsonReader]:
        """Return a list of objects, numbered from 1 in errors; an absent list is empty."""
        if name not in self.value:
            return []
        found = self.get(name, list)
        if len(found) > limit:
            self.fail(f'"{name}" has {len(found)} entries, more than {limit}')
        for number, each in enumerate(found, start=1):
            if not isinstance(each, dict):
                self.fail(f"{name} {number} is not an object")
        return [JsonReader(each, f"{self.where}: {name} {number}") for number, each in enumerate(found, start=1)]

    def number(self, name: str) -> float:
        """Return a finite number."""
        if name not in self.value:
            self.fail(f'"{name}" is missing')
        return self._number(self.value[name], f'"{name}"')

    def whole(self, name: str, limit: int) -> int:
        """Return a whole number from 0 to `limit`."""
        value = self.number(name)
        if value != int(value) or not 0 <= value <= limit:
            self.fail(f'"{name}" is not a whole number from 0 to {limit}')
        return int(value)

    def numbers(self, name: str, count: int, empty: float | None = None) -> list[float]:
        """Return a list of `count` numbers; null is `empty`, if that is allowed."""
        found = self.get(name, list)
        if len(found) != count:
            self.fail(f'"{name}" has {len(found)} numbers, not {count}')
        return [
            empty if each is None and empty is not None else self._number(each, f"{name}[{at}]")
            for at, each in enumerate(found)
        ]

    def items_of_numbers(self, name: str, count: int) -> list[list[float]]:
        """Return a list of lists of `count` numbers."""
        inner = (JsonReader({name: each}, f"{self.where}: {name} {at}") for at, each in enumerate(self._list(name), 1))
        return [each.numbers(name, count) for each in inner]

    def check_place(self, latitude: float, longitude: float) -> None:
        """Raise FileFormatError for a position that is not on Earth."""
        if fault := written_place_fault(latitude, longitude):
            self.fail(fault)

    def _list(self, name: str) -> list[Any]:
        return self.get(name, list)

    def _number(self, value: object, name: str) -> float:
        if isinstance(value, bool) or not isinstance(value, int | float):
            self.fail(f"{name} is not a number")
        if not is_float32(value):
            self.fail(f"{name} is too large")
        return float(value)


def written_place_fault(latitude: float, longitude: float) -> str | None:
    """Return why a position in a file is not on Earth, or None; the two may have changed places."""
    fault = place_fault(latitude, longitude)
    swapped = abs(latitude) > MAX_LATITUDE >= abs(longitude)
    return f"{fault}: latitude comes first" if swapped else fault
