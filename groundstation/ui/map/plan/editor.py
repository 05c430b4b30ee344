"""PlanEditor: the three plans as they are edited here, with undo, and what differs from the vehicle's.

Knows no widget, no clock and no file. Nothing goes to the vehicle before the screen sends it.
"""

from __future__ import annotations

from collections import deque

import msgspec

from groundstation.geo import Place
from groundstation.ui.map.plan.commands import NEW_ITEM, POLYGONS
from groundstation.ui.map.plan.geometry import DEGREES_SCALE, GLOBAL_FRAMES
from groundstation.ui.map.plan.rows import (
    Items,
    PlanDiff,
    Row,
    Rows,
    compare,
    find_origins,
    item_key,
    move_jumps,
    set_corner_count,
    span_at,
)
from groundstation.views.plan import MAX_ITEMS, PlanItem, PlanKind

MAX_UNDO = 100
RELATIVE = 3
"""MAV_FRAME_GLOBAL_RELATIVE_ALT."""


class _Step(msgspec.Struct, frozen=True):
    """What undo goes back to."""

    rows: dict[PlanKind, Rows]
    selected: dict[PlanKind, int]
    layer: PlanKind
    base: dict[PlanKind, Items]
    """The vehicle's plans to which the rows refer."""


class PlanEditor:
    """`layer` is the plan that keys edit; `base` are the plans of the vehicle, as far as they are known."""

    def __init__(self) -> None:
        self.layer = PlanKind.MISSION
        self.base: dict[PlanKind, Items] = {}
        self._rows: dict[PlanKind, Rows] = dict.fromkeys(PlanKind, ())
        self._selected = dict.fromkeys(PlanKind, 0)
        self._undo: deque[_Step] = deque(maxlen=MAX_UNDO)
        self._redo: deque[_Step] = deque(maxlen=MAX_UNDO)
        self._diffs: dict[PlanKind, tuple[Rows, Items, PlanDiff]] = {}

    # ---- what is there ----

    def rows(self, kind: PlanKind | None = None) -> Rows:
        """Return the rows of a plan, of the edited one by default."""
        return self._rows[self.layer if kind is None else kind]

    def items(self, kind: PlanKind) -> Items:
        """Return the items to upload."""
        return tuple(row.item for row in self._rows[kind])

    @property
    def selected(self) -> int:
        """Index of the selected row of the edited plan."""
        return self._selected[self.layer]

    @property
    def row(self) -> Row | None:
        """The selected row."""
        rows = self.rows()
        return rows[self.selected] if self.selected < len(rows) else None

    def was(self, row: Row, kind: PlanKind | None = None) -> PlanItem | None:
        """Return a row's item as the vehicle has it; None if it has none, or the same."""
        base = self.base.get(self.layer if kind is None else kind, ())
        before = base[row.origin] if row.origin is not None and row.origin < len(base) else None
        return None if before is None or item_key(before) == item_key(row.item) else before

    def diff(self, kind: PlanKind) -> PlanDiff:
        """Return what an upload of this plan would change."""
        rows, base = self._rows[kind], self.base.get(kind, ())
        known = self._diffs.get(kind)
        if known is None or known[0] is not rows or known[1] is not base:  # asked for several times in a frame
            known = self._diffs[kind] = (rows, base, compare(rows, base))
        return known[2]

    @property
    def edited(self) -> tuple[PlanKind, ...]:
        """The plans that are not as on the vehicle."""
        return tuple(kind for kind in PlanKind if self.diff(kind).count)

    # ---- plans of the vehicle and of files ----

    def load_base(self, kind: PlanKind, items: Items) -> None:
        """Show a plan of the vehicle. Edits stay; without any the plan is shown as it is there."""
        if not self.diff(kind).count:
            if self._rows[kind] and not items:
                self._remember()  # cleared there: undo has it back
            self._rows[kind] = tuple(Row(item) for item in items)
        self.base[kind] = items
        self._rows[kind] = find_origins(self._rows[kind], items)
        self._keep_selected(kind)

    def take_file(self, plans: dict[PlanKind, Items]) -> None:
        """Replace the plans that a file has."""
        self._remember()
        for kind, items in plans.items():
            self._rows[kind] = find_origins(tuple(Row(item) for item in items), self.base.get(kind, ()))
            self._selected[kind] = 0

    def revert(self, kind: PlanKind) -> None:
        """Drop the edits of a plan."""
        self._remember()
        base = self.base.get(kind, ())
        self._rows[kind] = tuple(Row(item, index) for index, item in enumerate(base))
        self._keep_selected(kind)

    # ---- selection ----

    def select(self, index: int) -> None:
        """Select a row of the edited plan."""
        self._selected[self.layer] = index
        self._keep_selected(self.layer)

    def next_layer(self) -> None:
        """Edit the next of the three plans."""
        self.layer = PlanKind((self.layer + 1) % len(PlanKind))

    # ---- edits ----

    def add(self, place: Place) -> str | None:
        """Add an item behind the selected one; return why that cannot be done."""
        rows = self.rows()
        if len(rows) >= MAX_ITEMS:
            return f"this screen edits {MAX_ITEMS} items at most"
        at = min(len(rows), self.selected + 1)
        self._remember()
        self._insert(at, self._new_item(place))
        self._selected[self.layer] = at
        return None

    def start_polygon(self, place: Place) -> str | None:
        """Begin another polygon at the end of the fence; return why that cannot be done."""
        rows = self.rows()
        if self.layer is not PlanKind.FENCE:
            return "polygons belong to the fence: e chooses it"
        if len(rows) >= MAX_ITEMS:
            return f"this screen edits {MAX_ITEMS} items at most"
        self._remember()
        item = PlanItem(NEW_ITEM[PlanKind.FENCE], RELATIVE, (1.0, 0.0, 0.0, 0.0), *_degrees(place), 0.0)
        self._rows[self.layer] = (*rows, Row(item))
        self._selected[self.layer] = len(rows)
        return None

    def remove(self) -> bool:
        """Remove the selected row; return False if there is none."""
        row, at = self.row, self.selected
        if row is None:
            return False
        self._remember()
        span = span_at(self.items(self.layer), at)
        rows = (*self.rows()[:at], *self.rows()[at + 1 :])
        if span is not None:
            rows = set_corner_count(rows, span[0], span[1] - 1)
        self._rows[self.layer] = move_jumps(rows, lambda target: target - 1 if target > at else target)
        self._keep_selected(self.layer)
        return True

    def move(self, by: int) -> bool:
        """Move the selected row by one; corners of a fence stay in their polygon. Return False if it cannot move."""
        at, to, rows = self.selected, self.selected + by, list(self.rows())
        if not (0 <= at < len(rows) and 0 <= to < len(rows)) or not self._in_one_polygon(at, to):
            return False
        self._remember()
        rows[at], rows[to] = rows[to], rows[at]
        swapped = {at: to, to: at}
        self._rows[self.layer] = move_jumps(rows, lambda target: swapped.get(target, target))
        self._selected[self.layer] = to
        return True

    def change(self, item: PlanItem) -> None:
        """Give the selected row another item."""
        row = self.row
        if row is None or item_key(item) == item_key(row.item):
            return
        self._remember()
        if item.command in POLYGONS or row.item.command in POLYGONS:
            self._change_corner(item)
        else:
            self._put(self.selected, Row(item, row.origin))

    def move_to(self, place: Place) -> str | None:
        """Give the selected row another place; return why that cannot be done."""
        row = self.row
        if row is None or row.item.frame not in GLOBAL_FRAMES:
            return "no item with a position is selected"
        x, y = _degrees(place)
        self.change(msgspec.structs.replace(row.item, x=x, y=y))
        return None

    # ---- undo ----

    def undo(self) -> bool:
        """Go back one step; return False if there is none."""
        return self._go(self._undo, self._redo)

    def redo(self) -> bool:
        """Go forward again; return False if nothing was undone."""
        return self._go(self._redo, self._undo)

    # ---- parts ----

    def _new_item(self, place: Place) -> PlanItem:
        row, kind = self.row, self.layer
        height = row.item.z if row is not None and row.item.frame in GLOBAL_FRAMES else 0.0
        frame = row.item.frame if row is not None and row.item.frame in GLOBAL_FRAMES else RELATIVE
        command = NEW_ITEM[kind]
        if kind is PlanKind.FENCE and row is not None and row.item.command in POLYGONS:
            command = row.item.command
        return PlanItem(command, frame, (0.0, 0.0, 0.0, 0.0), *_degrees(place), height)

    def _insert(self, at: int, item: PlanItem) -> None:
        span = span_at(self.items(self.layer), self.selected) if self.layer is PlanKind.FENCE else None
        rows = (*self.rows()[:at], Row(item), *self.rows()[at:])
        if item.command in POLYGONS:
            first, count = span if span is not None else (at, 0)
            rows = set_corner_count(rows, first, count + 1)
        self._rows[self.layer] = move_jumps(rows, lambda target: target + 1 if target >= at else target)

    def _change_corner(self, item: PlanItem) -> None:
        """Change a corner, or all corners of a polygon to another kind."""
        row, at = self.row, self.selected
        if row is None:
            return
        first, count = span_at(self.items(self.layer), at) or (at, 1)
        if item.command == row.item.command:
            self._put(at, Row(item, row.origin))
        elif item.command in POLYGONS:
            for index in range(first, first + max(1, count)):
                old = self.rows()[index]
                self._put(index, Row(msgspec.structs.replace(old.item, command=item.command), old.origin))
            if row.item.command not in POLYGONS:
                self._rows[self.layer] = set_corner_count(self.rows(), at, 1)
        else:  # a corner becomes a circle or a return point, behind what is left of its polygon
            rows = (*self.rows()[:at], *self.rows()[at + 1 :])
            rows = set_corner_count(rows, first, count - 1)
            to = first + count - 1
            self._rows[self.layer] = (*rows[:to], Row(item, row.origin), *rows[to:])
            self._selected[self.layer] = to

    def _in_one_polygon(self, at: int, to: int) -> bool:
        items = self.items(self.layer)
        return self.layer is not PlanKind.FENCE or span_at(items, at) == span_at(items, to)

    def _put(self, index: int, row: Row) -> None:
        rows = self.rows()
        self._rows[self.layer] = (*rows[:index], row, *rows[index + 1 :])

    def _keep_selected(self, kind: PlanKind) -> None:
        self._selected[kind] = max(0, min(self._selected[kind], len(self._rows[kind]) - 1))

    def _remember(self) -> None:
        self._undo.append(self._step())
        self._redo.clear()

    def _step(self) -> _Step:
        return _Step(dict(self._rows), dict(self._selected), self.layer, dict(self.base))

    def _go(self, back: deque[_Step], forth: deque[_Step]) -> bool:
        if not back:
            return False
        forth.append(self._step())
        step = back.pop()
        self._rows, self._selected, self.layer = dict(step.rows), dict(step.selected), step.layer
        for kind in PlanKind:
            if step.base.get(kind) is not self.base.get(kind):  # the vehicle has another plan by now
                self._rows[kind] = find_origins(self._rows[kind], self.base.get(kind, ()))
        return True


def _degrees(place: Place) -> tuple[int, int]:
    return round(place.latitude * DEGREES_SCALE), round(place.longitude * DEGREES_SCALE)
