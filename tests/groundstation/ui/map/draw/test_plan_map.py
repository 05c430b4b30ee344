"""The map widget, alone and as a pane of another screen."""

from __future__ import annotations

import math

from groundstation.ui.map.draw.plan_map import PlanMap
from groundstation.ui.map.draw.plan_map_value import LegState, MapLeg, MapMark, PlanMapValue
from groundstation.ui.map.draw.window import MapWindow
from groundstation.ui.map.pane import build_pane
from groundstation.ui.map.plan.copies import PlanCopies
from tests.groundstation.ui.example_map import pages, picture, plan_view, track
from tests.groundstation.ui.frames import texts


def drawn(value: PlanMapValue, width: int = 60, height: int = 20) -> list[str]:
    return texts(PlanMap(value).draw(width, height))


def test_the_pane_shows_the_plans_of_the_vehicle() -> None:
    copies = PlanCopies()
    for view in (plan_view(), *pages(), track()):
        copies.show_view(view)
    value = build_pane(copies, picture().vehicle)
    assert [leg.look for leg in value.legs].count(LegState.NOW) == 1
    assert (value.cursor, value.window, len(value.outlines)) == (None, None, 2)
    text = "\n".join(drawn(value))
    assert all(label in text for label in ("⌂", " 6 ", " R ", " 2 ", "✗", "N", "m"))
    assert all(len(line) <= 60 for line in drawn(value))


def test_without_a_position_the_reason_is_shown() -> None:
    vehicle = picture(gps_fix=2, gps_satellites=5, position=None).vehicle
    assert "no position: 2D fix, 5 satellites" in drawn(build_pane(PlanCopies(), vehicle))[10]
    assert "no vehicle" in drawn(build_pane(PlanCopies(), None))[10]


def test_a_finished_mission_has_no_leg_to_go() -> None:
    copies = PlanCopies()
    for view in (plan_view(state=5, current=0), *pages()):
        copies.show_view(view)
    assert {leg.look for leg in build_pane(copies, None).legs} == {LegState.DONE}


def test_what_is_far_outside_costs_nothing_and_is_cut() -> None:
    far = PlanMapValue(
        note="", window=MapWindow(), home=(1e9, -1e9), vehicle=(0.0, 0.0), heading=0.0,
        legs=(MapLeg((-1e7, 0.0), (1e7, 0.0)), MapLeg((1e8, 1e8), (1e8, 2e8))), marks=(MapMark((5e8, 0.0), "9"),),
    )  # fmt: skip
    lines = drawn(far)
    assert sum(any(0x2800 < ord(letter) < 0x2900 for letter in line) for line in lines) >= 15, "the leg crosses the map"
    assert not any("9" in line for line in lines)


def test_a_badge_has_its_ground_on_both_sides_of_the_number_only() -> None:
    value = PlanMapValue(note="", window=MapWindow(), marks=(MapMark((0.0, 0.0), "7", "now"),))
    [(text, style)] = [
        (segment.text, segment.style)
        for line in PlanMap(value).draw(60, 20)
        for segment in line
        if segment.style and segment.style.bgcolor and "7" in segment.text
    ]
    assert text == " 7 "
    assert style.bgcolor is not None


def test_in_ascii_the_vehicle_is_one_character() -> None:
    value = PlanMapValue(note="", window=MapWindow(), vehicle=(0.0, 0.0), heading=math.pi / 2, ascii=True)
    assert any(">" in line for line in drawn(value))
