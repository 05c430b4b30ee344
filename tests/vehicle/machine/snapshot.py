"""Save and restore the state of live objects in place, so that one rover can be tried with each event in each state.

A copy of the whole rover takes 4 ms and leaves closures behind that act on the original. Here the objects that exist
from the start keep their identity; only their attributes are saved and set again.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterable
from copy import copy
from enum import Enum
from functools import partial
from typing import Any

PARTS = (
    "vehicle.drive", "vehicle.safety", "vehicle.autonomy", "vehicle.navigation", "vehicle.commands", "vehicle.rover",
)  # fmt: skip
"""Modules whose objects hold what decides about motion. Texts, telemetry and files are shared by all states."""
WITHOUT_STATE = ("vehicle.commands.context", "vehicle.commands.params", "vehicle.commands.files")

PLAIN = frozenset((float, int, bool, str, type(None)))
VALUES = (int, float, str, bytes, type(None), Enum, type, tuple, frozenset)


def attributes(owner: object) -> Iterable[str]:
    """Return the names of the attributes that an object has now."""
    yield from getattr(owner, "__dict__", ())
    for kind in type(owner).__mro__:
        yield from (name for name in getattr(kind, "__slots__", ()) if hasattr(owner, name))


def is_value(kind: type) -> bool:
    """Return whether objects of a class never change."""
    if issubclass(kind, VALUES) or any("__call__" in vars(each) for each in kind.__mro__):
        return True
    config = getattr(kind, "__struct_config__", None) or getattr(kind, "__dataclass_params__", None)
    return bool(getattr(config, "frozen", False))


def is_part(kind: type) -> bool:
    """Return whether objects of a class hold what decides about motion."""
    return kind.__module__.startswith(PARTS) and not kind.__module__.startswith(WITHOUT_STATE)


Saved = list[tuple[dict[str, Any], list[tuple[str, Callable[[], Any]]]]]
"""For each object what never changes by itself, and what makes a copy of the rest."""


class Snapshots:
    """Saves and restores what can be reached from `root` through the modules in PARTS."""

    def __init__(self, root: object) -> None:
        self._fixed: dict[int, object] = {}
        self._shared: dict[type, bool] = {}
        """Class -> whether all states share its objects. Kept, because each restore asks for thousands."""
        self._find(root)
        self._values = [vars(each) for each in self._fixed.values()]

    def save(self) -> Saved:
        """Return a copy of all attributes."""
        return [self._save_one(values) for values in self._values]

    def restore(self, saved: Saved) -> None:
        """Set all attributes as they were at `save`."""
        for values, (plain, copied) in zip(self._values, saved, strict=True):
            values.update(plain)
            for name, make in copied:
                values[name] = make()

    def _save_one(self, values: dict[str, Any]) -> tuple[dict[str, Any], list[tuple[str, Any]]]:
        plain: dict[str, Any] = {}
        copied: list[tuple[str, Callable[[], Any]]] = []
        for name, value in values.items():
            twin = self._copy(value)
            if twin is value:
                plain[name] = value
            else:
                copied.append((name, self._copier(twin)))
        return plain, copied

    def _copier(self, twin: Any) -> Callable[[], Any]:
        """Return what copies a saved value again.

        What of it never changes is found out once, because each state is restored for each event.
        """
        kind = type(twin)
        if kind is dict:
            return self._table_copier(twin, list(twin.items()))
        if kind is list or kind is deque:
            return self._table_copier(twin, list(enumerate(twin)))
        attributes_of = [(name, getattr(twin, name)) for name in attributes(twin)]
        changing = [(name, self._copier(value)) for name, value in attributes_of if self._copy(value) is not value]
        return partial(_copy_object, twin, changing)

    def _table_copier(self, twin: Any, items: list[tuple[Any, Any]]) -> Callable[[], Any]:
        """Return what copies a table. Most have plain values only, and copy themselves fast."""
        changing = [(key, self._copier(value)) for key, value in items if self._copy(value) is not value]
        return partial(_copy_table, twin, changing) if changing else twin.copy

    def _find(self, item: object) -> None:
        """Collect the long-lived objects."""
        if isinstance(item, list | deque | tuple | set):
            for each in item:
                self._find(each)
        elif isinstance(item, dict):
            for each in item.values():
                self._find(each)
        elif not self._is_shared(type(item)) and hasattr(item, "__dict__") and id(item) not in self._fixed:
            self._fixed[id(item)] = item
            for name in list(attributes(item)):
                self._find(getattr(item, name))

    def _is_shared(self, kind: type) -> bool:
        if kind not in self._shared:
            self._shared[kind] = is_value(kind) or not is_part(kind)
        return self._shared[kind]

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
        if self._is_shared(kind):
            return item
        return self._copy_object(item)

    def _copy_object(self, item: Any) -> Any:
        """Copy an object that is younger than the rover, such as the driver."""
        twin = copy(item)
        for name in attributes(item):
            setattr(twin, name, self._copy(getattr(item, name)))
        return twin


def _copy_table(twin: Any, changing: list[tuple[Any, Callable[[], Any]]]) -> Any:
    made = twin.copy()
    for key, make in changing:
        made[key] = make()
    return made


def _copy_object(twin: Any, changing: list[tuple[str, Callable[[], Any]]]) -> Any:
    made = copy(twin)
    for name, make in changing:
        setattr(made, name, make())
    return made
