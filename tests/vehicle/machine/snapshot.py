"""Save and restore the state of live objects in place, so that one rover can be tried with each event in each state.

A copy of the whole rover takes 4 ms and leaves closures behind that act on the original. Here the objects that exist
from the start keep their identity; only their attributes are saved and set again.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable
from copy import copy
from enum import Enum
from typing import Any

PARTS = (
    "vehicle.drive", "vehicle.safety", "vehicle.autonomy", "vehicle.navigation", "vehicle.commands", "vehicle.rover",
)  # fmt: skip
"""Modules whose objects hold what decides about motion. Texts, telemetry and files are shared by all states."""
WITHOUT_STATE = ("vehicle.commands.context", "vehicle.commands.params", "vehicle.commands.files")

PLAIN = (float, int, bool, str, type(None))


def attributes(owner: object) -> Iterable[str]:
    """Return the names of the attributes that an object has now."""
    yield from getattr(owner, "__dict__", ())
    for kind in type(owner).__mro__:
        yield from (name for name in getattr(kind, "__slots__", ()) if hasattr(owner, name))


def is_value(item: object) -> bool:
    """Return whether an object never changes."""
    if item is None or isinstance(item, int | float | str | bytes | Enum | type | tuple | frozenset) or callable(item):
        return True
    kind = getattr(item, "__struct_config__", None) or getattr(item, "__dataclass_params__", None)
    return bool(getattr(kind, "frozen", False))


Saved = list[tuple[dict[str, Any], list[tuple[str, Any]]]]
"""For each object what never changes by itself, and what must be copied."""


class Snapshots:
    """Saves and restores what can be reached from `root` through the modules in PARTS."""

    def __init__(self, root: object) -> None:
        self._fixed: dict[int, object] = {}
        self._find(root)
        self._values = [vars(each) for each in self._fixed.values()]

    def save(self) -> Saved:
        """Return a copy of all attributes."""
        return [self._save_one(values) for values in self._values]

    def restore(self, saved: Saved) -> None:
        """Set all attributes as they were at `save`."""
        for values, (plain, copied) in zip(self._values, saved, strict=True):
            values.update(plain)
            for name, value in copied:
                values[name] = self._copy(value)

    def _save_one(self, values: dict[str, Any]) -> tuple[dict[str, Any], list[tuple[str, Any]]]:
        plain, copied = {}, []
        for name, value in values.items():
            twin = self._copy(value)
            if twin is value:
                plain[name] = value
            else:
                copied.append((name, twin))
        return plain, copied

    def _find(self, item: object) -> None:
        """Collect the long-lived objects."""
        if isinstance(item, list | deque | tuple | set):
            for each in item:
                self._find(each)
        elif isinstance(item, dict):
            for each in item.values():
                self._find(each)
        elif not is_value(item) and id(item) not in self._fixed and self._is_part(item) and hasattr(item, "__dict__"):
            self._fixed[id(item)] = item
            for name in list(attributes(item)):
                self._find(getattr(item, name))

    @staticmethod
    def _is_part(item: object) -> bool:
        module = type(item).__module__
        return module.startswith(PARTS) and not module.startswith(WITHOUT_STATE)

    def _copy(self, item: Any) -> Any:
        kind = type(item)
        if kind in PLAIN or id(item) in self._fixed:
            return item
        if kind is dict:
            return {key: self._copy(value) for key, value in item.items()}
        if kind is list:
            return [self._copy(each) for each in item]
        if kind is deque:
            return deque((self._copy(each) for each in item), item.maxlen)
        if is_value(item) or not self._is_part(item):
            return item
        return self._copy_object(item)

    def _copy_object(self, item: Any) -> Any:
        """Copy an object that is younger than the rover, such as the driver."""
        twin = copy(item)
        for name in attributes(item):
            setattr(twin, name, self._copy(getattr(item, name)))
        return twin
