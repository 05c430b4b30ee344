"""BoundedOutput: what a verb prints, kept for an agent, up to a size. Texts of vehicles lose what cannot be printed."""

from __future__ import annotations

import math
from typing import Any

import msgspec

from dialects.printable import printable
from groundstation.vehicles.requests.requests import RequestReport

MOST_BYTES = 48 << 10
"""Bytes of JSON that one call returns."""
MOST_RECORDS = 400
LONGEST_NOTE = 300


class BoundedOutput:
    """Has the methods of Output."""

    as_json = True

    def __init__(self, verb: str) -> None:
        self.verb = verb
        self._records: list[Any] = []
        self._notes: list[str] = []
        self._fields: dict[str, Any] = {}
        self._left = MOST_BYTES
        self._left_out = 0

    @property
    def last_note(self) -> str:
        """The newest note or error."""
        return self._notes[-1] if self._notes else ""

    def build(self) -> dict[str, Any]:
        """Return all that was printed."""
        built: dict[str, Any] = dict(self._fields)
        if self._records:
            built["records"] = self._records
        if self._notes:
            built["notes"] = self._notes
        if self._left_out:
            built["left_out"] = f"{self._left_out} more: ask for less"
        return built

    def line(self, text: str) -> None:
        """Leave out lines for a person: the same is in records."""

    def record(self, **fields: Any) -> None:
        """Keep an object."""
        self._keep(self._records, clean(fields))

    def result(self, ok: bool, vehicle: int | None, **fields: Any) -> None:
        """Keep how the verb ended."""
        self._fields = {"ok": ok, "vehicle": vehicle, **clean(fields)}

    def flush(self) -> None:
        """Do nothing."""

    def note(self, text: str) -> None:
        """Keep a note."""
        self._keep(self._notes, printable(text)[:LONGEST_NOTE])

    def error(self, text: str) -> None:
        """Keep an error."""
        self.note(text)

    def progress(self, report: RequestReport) -> None:
        """Leave out the progress."""

    def count(self, what: str, done: int, total: int | None) -> None:
        """Leave out the progress."""

    def clear_progress(self) -> None:
        """Do nothing."""

    def _keep(self, kept: list[Any], value: Any) -> None:
        size = len(msgspec.json.encode(value))
        if size > self._left or len(kept) >= MOST_RECORDS:
            self._left_out += 1
            return
        self._left -= size
        kept.append(value)


def clean(value: Any) -> Any:
    """Return a value as JSON has it, its texts printable."""
    value = msgspec.to_builtins(value)
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    if isinstance(value, str):
        return printable(value)
    if isinstance(value, dict):
        return {printable(str(name)): clean(each) for name, each in value.items()}
    if isinstance(value, list | tuple):
        return [clean(each) for each in value]
    return value
