"""Changes of parameters that are not written yet, with undo and redo. Knows no widget."""

from __future__ import annotations

from collections.abc import Iterable

import msgspec

from link.services.param.float32 import same_float32

MAX_UNDO = 100
"""Steps that can be undone."""


class PendingChange(msgspec.Struct, frozen=True):
    """A value that is not written yet."""

    name: str
    before: float
    value: float

    @property
    def changes_value(self) -> bool:
        """Whether the values differ: whole numbers exactly, for integers may have more digits than a float32."""
        if self.value.is_integer() and self.before.is_integer():
            return self.value != self.before
        return not same_float32(self.value, self.before)

    @property
    def reverse(self) -> PendingChange:
        """The change that undoes this one."""
        return PendingChange(self.name, self.value, self.before)


class PendingChanges:
    """The changes by name, and the steps before and after."""

    def __init__(self) -> None:
        self.by_name: dict[str, PendingChange] = {}
        self._undo: list[dict[str, PendingChange]] = []
        self._redo: list[dict[str, PendingChange]] = []

    def set(self, changes: Iterable[PendingChange]) -> None:
        """Add or replace changes in one step; one to the value that it has is dropped."""
        new = dict(self.by_name)
        for change in changes:
            new.pop(change.name, None)
            if change.changes_value:
                new[change.name] = change
        self._step(new)

    def drop(self, name: str) -> bool:
        """Drop a change; return whether there was one."""
        if name not in self.by_name:
            return False
        self._step({each: change for each, change in self.by_name.items() if each != name})
        return True

    def undo(self) -> bool:
        """Go back one step."""
        if self._undo:
            self._redo.append(self.by_name)
            self.by_name = self._undo.pop()
            return True
        return False

    def redo(self) -> bool:
        """Go forward one step."""
        if self._redo:
            self._undo.append(self.by_name)
            self.by_name = self._redo.pop()
            return True
        return False

    def take_written(self, written: Iterable[PendingChange]) -> None:
        """Drop what was written; the only step that can be undone then makes the old values pending again."""
        done = tuple(written)
        left = {name: change for name, change in self.by_name.items() if name not in {each.name for each in done}}
        self._undo = [{**left, **{each.name: each.reverse for each in done}}] if done else []
        self.by_name, self._redo = left, []

    def clear(self) -> None:
        """Forget all: they were for another vehicle."""
        self.by_name, self._undo, self._redo = {}, [], []

    def _step(self, new: dict[str, PendingChange]) -> None:
        if new != self.by_name:
            self._undo = [*self._undo[1 - MAX_UNDO :], self.by_name]
            self.by_name, self._redo = new, []
