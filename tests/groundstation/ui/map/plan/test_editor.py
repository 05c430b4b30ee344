"""The edit model: add, remove, order, undo, marks; DO_JUMP and corners of fences follow their rows."""

from __future__ import annotations

import math
from collections.abc import Callable

import msgspec
from hypothesis import given, settings
from hypothesis import strategies as st

from groundstation.ui.map.plan.commands import CIRCLE_IN, DO_JUMP, POLYGON_IN, POLYGON_OUT
from groundstation.ui.map.plan.editor import MAX_UNDO, PlanEditor
from groundstation.ui.map.plan.fields import change_command
from groundstation.ui.map.plan.rows import PlanDiff, item_key, polygon_spans
from groundstation.views.plan import MAX_ITEMS, PlanItem, PlanKind
from tests.groundstation.ui.map.plans import at, item, square, task

MISSION, FENCE, RALLY = PlanKind


def editor_with(*items: PlanItem, layer: PlanKind = MISSION) -> PlanEditor:
    """As the vehicle has them."""
    editor = PlanEditor()
    editor.layer = layer
    editor.load_base(layer, items)
    return editor


def norths(editor: PlanEditor) -> list[int]:
    return [round((row.item.x / 1e7 + 35.3632621) * 111_319.5) for row in editor.rows()]


def test_a_plan_of_the_vehicle_has_no_edits() -> None:
    editor = editor_with(item(north=1), item(north=2))
    assert editor.diff(MISSION) == PlanDiff()
    assert editor.edited == ()


def test_items_are_added_behind_the_selected_one() -> None:
    editor = editor_with(item(north=1), item(north=2))
    editor.add(at(5, 0))
    assert norths(editor) == [1, 5, 2]
    assert editor.selected == 1
    editor.add(at(6, 0))
    assert norths(editor) == [1, 5, 6, 2]
    assert editor.diff(MISSION) == PlanDiff(new=2)
    editor.remove()
    assert norths(editor) == [1, 5, 2]
    assert editor.diff(MISSION).text == "1 new"


def test_the_diff_names_what_changed() -> None:
    editor = editor_with(item(north=1), item(north=2), item(north=3))
    editor.move_to(at(9, 0))
    assert editor.diff(MISSION) == PlanDiff(changed=1)
    row = editor.row
    assert row is not None
    assert editor.was(row) == item(north=1)
    editor.move(1)
    assert editor.diff(MISSION).text == "1 changed, other order"
    editor.remove()
    assert editor.diff(MISSION) == PlanDiff(removed=1)


def test_equal_items_that_change_places_are_no_difference() -> None:
    editor = editor_with(item(north=2), item(north=2))
    assert editor.move(1)
    assert editor.edited == ()


def test_nan_is_equal_to_nan() -> None:
    there = item(16, 1, 0, math.nan, float("nan"))
    editor = editor_with(there)
    again = msgspec.structs.replace(there, params=(float("nan"), math.nan, 0.0, 0.0))
    editor.load_base(MISSION, (again,))
    assert editor.diff(MISSION) == PlanDiff()
    editor.change(there)
    assert not editor.undo(), "a change to the same item is none"


def test_the_target_of_a_jump_follows_its_item() -> None:
    editor = editor_with(item(north=1), item(north=2), item(north=3), task(DO_JUMP, 1.0, 2.0))

    def target() -> float:
        return next(row.item.params[0] for row in editor.rows() if row.item.command == DO_JUMP)

    editor.select(0)
    editor.add(at(5, 0))
    assert target() == 2
    editor.select(2)
    editor.move(-1)
    assert target() == 1
    editor.select(0)
    editor.remove()
    assert target() == 0
    assert norths(editor)[0] == 2


def test_the_corners_of_a_polygon_are_counted() -> None:
    editor = editor_with(*square(10), item(CIRCLE_IN, 0, 0, 5.0), layer=FENCE)
    editor.select(3)
    editor.add(at(-10, -20))
    assert [row.item.params[0] for row in editor.rows()] == [5, 5, 5, 5, 5, 5.0]
    assert polygon_spans(editor.items(FENCE)) == [(0, 5)]
    editor.remove()
    assert polygon_spans(editor.items(FENCE)) == [(0, 4)]
    editor.select(4)
    editor.add(at(50, 50))
    editor.add(at(50, 60))
    assert polygon_spans(editor.items(FENCE)) == [(0, 4), (5, 2)]


def test_a_second_polygon_of_the_same_kind_stays_apart() -> None:
    editor = editor_with(*square(10), layer=FENCE)
    assert editor.start_polygon(at(50, 0)) is None
    editor.add(at(50, 10))
    editor.add(at(60, 10))
    assert polygon_spans(editor.items(FENCE)) == [(0, 4), (4, 3)]
    editor.select(4)
    assert not editor.move(-1), "a corner does not change its polygon"
    editor.layer = MISSION
    assert editor.start_polygon(at(0, 0)) == "polygons belong to the fence: e chooses it"


def test_a_corner_can_become_a_circle_and_a_polygon_an_exclusion() -> None:
    editor = editor_with(*square(10), layer=FENCE)
    editor.change(change_command(editor.items(FENCE)[0], POLYGON_OUT))
    assert {row.item.command for row in editor.rows()} == {POLYGON_OUT}
    editor.change(change_command(editor.items(FENCE)[0], CIRCLE_IN))
    assert polygon_spans(editor.items(FENCE)) == [(0, 3)]
    assert [row.item.command for row in editor.rows()][3] == CIRCLE_IN
    assert editor.row is not None
    assert (editor.row.item.command, editor.row.item.params[0]) == (CIRCLE_IN, 5.0)
    editor.change(change_command(editor.row.item, POLYGON_IN))
    assert polygon_spans(editor.items(FENCE)) == [(0, 3), (3, 1)]


def test_edits_survive_another_plan_of_the_vehicle() -> None:
    editor = editor_with(item(north=1), item(north=2))
    editor.add(at(5, 0))
    editor.load_base(MISSION, (item(north=2), item(north=7)))
    assert norths(editor) == [1, 5, 2]
    assert editor.diff(MISSION) == PlanDiff(new=2, removed=1)


def test_an_accepted_upload_leaves_no_edits_and_undo_still_works() -> None:
    editor = editor_with(item(north=1))
    editor.add(at(5, 0))
    editor.load_base(MISSION, editor.items(MISSION))
    assert editor.edited == ()
    assert editor.undo()
    assert norths(editor) == [1]
    assert editor.diff(MISSION) == PlanDiff(removed=1)


def test_a_plan_that_was_cleared_there_can_be_had_back() -> None:
    editor = editor_with(item(north=1))
    editor.load_base(MISSION, ())
    assert editor.rows() == ()
    assert editor.undo()
    assert editor.diff(MISSION) == PlanDiff(new=1)


def test_a_download_drops_the_edits_until_undo() -> None:
    editor = editor_with(item(north=1))
    editor.add(at(5, 0))
    editor.revert(MISSION)
    assert norths(editor) == [1]
    editor.undo()
    assert norths(editor) == [1, 5]


def test_undo_goes_back_a_hundred_steps() -> None:
    editor = PlanEditor()
    for number in range(MAX_UNDO + 20):
        editor.add(at(number, 0))
    undone = 0
    while editor.undo():
        undone += 1
    assert undone == MAX_UNDO
    assert len(editor.rows()) == 20
    while editor.redo():
        undone -= 1
    assert (undone, len(editor.rows())) == (0, MAX_UNDO + 20)


def test_a_plan_has_a_largest_size() -> None:
    editor = editor_with(*(item(north=number) for number in range(MAX_ITEMS)))
    assert editor.add(at(0, 0)) == f"this screen edits {MAX_ITEMS} items at most"


def test_nothing_can_be_done_without_an_item() -> None:
    editor = PlanEditor()
    assert editor.row is None
    assert not editor.remove()
    assert not editor.move(1)
    assert editor.move_to(at(0, 0)) == "no item with a position is selected"
    editor.change(item())
    assert not editor.undo()
    assert not editor.redo()


def change_to_circle(editor: PlanEditor) -> None:
    if editor.row is not None:
        editor.change(change_command(editor.row.item, CIRCLE_IN))


EDITS: dict[str, Callable[[PlanEditor, int], object]] = {
    "add": lambda editor, number: editor.add(at(number, number)),
    "polygon": lambda editor, number: editor.start_polygon(at(number, 3)),
    "remove": lambda editor, number: editor.remove(),
    "up": lambda editor, number: editor.move(-1),
    "down": lambda editor, number: editor.move(1),
    "select": lambda editor, number: editor.select(number),
    "place": lambda editor, number: editor.move_to(at(number, 7)),
    "jump": lambda editor, number: editor.change(task(DO_JUMP, float(number), 1.0)),
    "layer": lambda editor, number: editor.next_layer(),
    "circle": lambda editor, number: change_to_circle(editor),
    "upload": lambda editor, number: editor.load_base(editor.layer, editor.items(editor.layer)),
    "other": lambda editor, number: editor.load_base(MISSION, (item(north=number), item(north=2))),
    "undo": lambda editor, number: editor.undo(),
    "redo": lambda editor, number: editor.redo(),
}


@settings(max_examples=60, deadline=None)
@given(st.lists(st.tuples(st.sampled_from(sorted(EDITS)), st.integers(0, 6)), max_size=40))
def test_no_order_of_edits_breaks_the_plans(steps: list[tuple[str, int]]) -> None:
    editor = editor_with(*square(10), layer=FENCE)
    editor.load_base(MISSION, (item(north=1), item(north=2), task(DO_JUMP, 0.0, 1.0)))
    for name, number in steps:
        EDITS[name](editor, number)
        for kind in PlanKind:
            rows, base = editor.rows(kind), editor.base.get(kind, ())
            origins = [row.origin for row in rows if row.origin is not None]
            assert len(set(origins)) == len(origins)
            assert all(origin < len(base) for origin in origins)
            assert (editor.diff(kind).count == 0) == (list(map(item_key, editor.items(kind))) == [*map(item_key, base)])
        assert 0 <= editor.selected <= max(0, len(editor.rows()) - 1)
    before = {kind: editor.items(kind) for kind in PlanKind}
    if editor.undo():
        assert editor.redo()
        assert {kind: editor.items(kind) for kind in PlanKind} == before
