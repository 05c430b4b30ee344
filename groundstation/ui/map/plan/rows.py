"""Rows of a plan that is edited: an item and where it comes from, polygons of a fence, targets of DO_JUMP."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Any

import msgspec

from groundstation import plan_key
from groundstation.ui.map.plan.commands import DO_JUMP, POLYGONS, has_location
from groundstation.views.plan import PlanItem

Items = tuple[PlanItem, ...]


class Row(msgspec.Struct, frozen=True):
    """One item of the plan that is edited."""

    item: PlanItem
    origin: int | None = None
    """Its index in the vehicle's plan; None: it is new."""


Rows = tuple[Row, ...]


class PlanDiff(msgspec.Struct, frozen=True):
    """What an upload would change."""

    changed: int = 0
    new: int = 0
    removed: int = 0
    reordered: bool = False

    @property
    def count(self) -> int:
        """How many items differ."""
        return self.changed + self.new + self.removed + (1 if self.reordered else 0)

    @property
    def text(self) -> str:
        """Return it in words, empty if nothing differs."""
        numbers = {"changed": self.changed, "new": self.new, "removed": self.removed}
        parts = [f"{count} {word}" for word, count in numbers.items() if count]
        return ", ".join([*parts, "other order"] if self.reordered else parts)


def item_key(item: PlanItem) -> tuple[Any, ...]:
    """Return what two items that are the same for a vehicle have in common."""
    return tuple(plan_key.item_key(item, located=has_location(item.command)).values())


def compare(rows: Rows, base: Items) -> PlanDiff:
    """Return what differs between the rows and the vehicle's plan; equal items may have changed places."""
    if [item_key(row.item) for row in rows] == [item_key(item) for item in base]:
        return PlanDiff()
    kept = [row.origin for row in rows if row.origin is not None]
    changed = sum(
        row.origin is not None and item_key(row.item) != item_key(base[row.origin])
        for row in rows
    )  # fmt: skip
    return PlanDiff(changed, len(rows) - len(kept), len(base) - len(kept), kept != sorted(kept))


def find_origins(rows: Rows, base: Items) -> Rows:
    """Return the rows with their origins in another plan of the vehicle: equal items, in their order."""
    places: dict[tuple[Any, ...], list[int]] = {}
    for index, item in enumerate(base):
        places.setdefault(item_key(item), []).append(index)
    found = []
    for row in rows:
        left = places.get(item_key(row.item))
        found.append(Row(row.item, left.pop(0) if left else None))
    return tuple(found)


def move_jumps(rows: Sequence[Row], to: Callable[[int], int]) -> Rows:
    """Return the rows with the targets of DO_JUMP at their new places."""
    return tuple(_move_jump(row, to) if row.item.command == DO_JUMP else row for row in rows)


def _move_jump(row: Row, to: Callable[[int], int]) -> Row:
    target, *others = row.item.params
    if not math.isfinite(target) or to(int(target)) == target:
        return row
    params = (float(to(int(target))), *others)
    return Row(msgspec.structs.replace(row.item, params=params), row.origin)


def polygon_spans(items: Sequence[PlanItem]) -> list[tuple[int, int]]:
    """Return first index and number of corners of each polygon. A number that does not fit is cut to the same corners.

    Fences of vehicles and files name the number of corners in parameter 1 of each corner.
    """
    spans, at = [], 0
    while at < len(items):
        item, count = items[at], 1
        if item.command in POLYGONS:
            wanted = item.params[0]
            most = int(wanted) if math.isfinite(wanted) and wanted >= 1 else 1
            same = (each.command == item.command and each.params[0] == wanted for each in items[at : at + most])
            count = max(1, next((index for index, equal in enumerate(same) if not equal), min(most, len(items) - at)))
            spans.append((at, count))
        at += count
    return spans


def span_at(items: Sequence[PlanItem], index: int) -> tuple[int, int] | None:
    """Return the polygon that a corner belongs to."""
    return next((span for span in polygon_spans(items) if span[0] <= index < sum(span)), None)


def set_corner_count(rows: Rows, first: int, count: int) -> Rows:
    """Return the rows with the number of corners of one polygon set."""

    def counted(row: Row) -> Row:
        params = (float(count), *row.item.params[1:])
        return Row(msgspec.structs.replace(row.item, params=params), row.origin)

    return tuple(counted(row) if first <= index < first + count else row for index, row in enumerate(rows))
