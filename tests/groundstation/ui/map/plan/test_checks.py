"""Checks before an upload, and the fence."""

from __future__ import annotations

import math

import msgspec
import pytest

from groundstation.ui.map.plan.checks import check_fence, fence_shapes, item_fault, plan_fault, range_warning
from groundstation.ui.map.plan.geometry import distance_to_line, is_inside, place_of
from groundstation.views.plan import PlanItem
from tests.groundstation.ui.map.plans import AROUND, item, square, task


def test_a_fence_of_inclusions_and_exclusions() -> None:
    shapes = fence_shapes((*square(20), item(5004, 10, 10, 4.0), item(5003, 0, 0, 100.0)), AROUND)
    assert len(shapes) == 3

    def inside(north: float, east: float) -> bool:
        check = check_fence((north, east), shapes)
        assert check is not None
        return check.inside

    assert inside(0, 0)
    assert not inside(0, 21), "outside the polygon"
    assert not inside(10, 11), "in the circle that is excluded"
    assert inside(10, 15)
    check = check_fence((0, 15), shapes)
    assert check is not None
    assert check.distance == pytest.approx(5.0, abs=0.1)
    assert check_fence((0, 0), ()) is None


def test_shapes_that_are_not_complete_are_left_out() -> None:
    corners = tuple(msgspec.structs.replace(each, params=(2.0, 0.0, 0.0, 0.0)) for each in square(5)[:2])
    nowhere = PlanItem(5003, 3, (5.0, 0.0, 0.0, 0.0), 0, 0, 0.0)
    endless = item(5003, 0, 0, math.inf)
    assert fence_shapes((*corners, nowhere, endless), AROUND) == ()


@pytest.mark.parametrize(
    ("items", "fault"),
    [
        ((item(16), msgspec.structs.replace(item(16), x=950_000_000)), "item 1: latitude 95 is not in -90 to 90"),
        ((msgspec.structs.replace(item(16), y=-1_900_000_000),), "item 0: longitude -190 is not in -180 to 180"),
        ((item(16, 0, 0, math.inf),), "item 0: a parameter is infinite"),
        ((msgspec.structs.replace(item(16), z=math.inf),), "item 0: the altitude is infinite"),
        ((item(16), task(177, 2.0, 1.0)), "item 1: it jumps to an item that does not exist"),
        ((item(16), task(177, math.nan, 1.0)), "item 1: it jumps to an item that does not exist"),
        (square(5)[:3], "item 0: the polygon shall have 4 corners and has 3"),
        (square(5)[:2], "item 0: a polygon needs 3 corners, this one has 2"),
    ],
)
def test_what_no_vehicle_can_use(items: tuple[PlanItem, ...], fault: str) -> None:
    assert plan_fault(items) == fault


def test_a_plan_that_can_be_uploaded() -> None:
    assert plan_fault((item(16, 1), task(177, 0.0, 3.0), task(20), item(16, 0, 0, math.nan))) is None
    assert plan_fault(square(5)) is None
    assert item_fault(task(31_999, 5.0)) is None


def test_values_out_of_range_are_only_warned_of() -> None:
    assert range_warning(item(16, 0, 0, -5.0)) == "hold is 0 or more s"
    assert range_warning(item(16)) is None


def test_places_and_ways() -> None:
    assert place_of(task(20)) is None
    assert place_of(PlanItem(16, 3, (0.0, 0.0, 0.0, 0.0), 0x7FFF_FFFF, 5, 0.0)) is None
    assert place_of(msgspec.structs.replace(item(16), x=950_000_000)) is None
    assert distance_to_line((3, 5), (0, 0), (0, 10)) == 3.0
    assert distance_to_line((3, 5), (0, 5), (0, 5)) == 3.0
    assert is_inside((1, 1), [(0, 0), (0, 4), (4, 4), (4, 0)])
