"""How far a vehicle is with its mission, from what it sends."""

from __future__ import annotations

import pytest

from dialects import messages as m
from groundstation.vehicles.state.plan_progress import FRESH, MAX_REACHED, PlanProgress
from tests.link.command_rig import received

NOT_STARTED, ACTIVE, PAUSED, COMPLETE = 2, 3, 4, 5


def heard(progress: PlanProgress, *messages: m.Message, now: float = 0.0, component: int = 1) -> PlanProgress:
    for message in messages:
        progress.receive(received(message, 1, component), now)
    return progress


def current(seq: int, state: int = ACTIVE, mission: int = 0) -> m.MissionCurrent:
    return m.MissionCurrent(seq, 9, state, 1, mission, 0, 0)


def test_reached_items_count_until_the_mission_begins_anew() -> None:
    progress = heard(PlanProgress(1), current(0), m.MissionItemReached(0), current(1), m.MissionItemReached(1))
    assert (progress.current, progress.reached) == (1, (0, 1))
    assert heard(progress, current(1, PAUSED), current(1)).reached == (0, 1)
    assert heard(progress, current(0, COMPLETE)).reached == (0, 1)
    assert not heard(progress, current(0)).reached


def test_a_jump_back_forgets_what_lies_behind() -> None:
    progress = heard(PlanProgress(1), *(m.MissionItemReached(seq) for seq in range(5)), current(5), current(2))
    assert progress.reached == (0, 1)


def test_another_mission_begins_without_reached_items() -> None:
    progress = heard(PlanProgress(1), current(3), m.MissionItemReached(2), current(0, NOT_STARTED))
    assert progress.reached == ()


def test_ids_are_only_those_that_the_vehicle_reports() -> None:
    progress = heard(PlanProgress(1), current(0))
    assert progress.ids is None
    heard(progress, current(0, mission=7), current(0))
    assert progress.ids == (0, 0, 0), "it has ids, and no plan now"


def test_the_way_to_go_is_fresh_and_finite() -> None:
    nav = m.NavControllerOutput(0.0, 0.0, 0, 0, 12, 0.0, 0.0, -0.5)
    progress = heard(PlanProgress(1), nav, now=10.0)
    found = progress.nav_output(10.0)
    assert found is not None
    assert found.wp_dist == 12
    assert progress.nav_output(10.1 + FRESH) is None
    nav.xtrack_error = float("nan")
    assert heard(progress, nav, now=20.0).nav_output(20.0) is None


def test_home_has_the_altitude_of_the_vehicle_until_it_is_known() -> None:
    position = m.GlobalPositionInt(0, 1, 1, 584_000, 0, 0, 0, 0, 0)
    progress = heard(PlanProgress(1), position)
    assert progress.home_altitude == 584.0
    home = m.HomePosition(1, 1, 600_500, 0.0, 0.0, 0.0, [1.0, 0.0, 0.0, 0.0], 0.0, 0.0, 0.0)
    assert heard(progress, home, position).home_altitude == 600.5


@pytest.mark.parametrize("component", [154, 190])
def test_other_components_do_not_count(component: int) -> None:
    assert heard(PlanProgress(1), current(4), component=component).current is None


def test_a_flood_of_reached_items_is_bounded() -> None:
    progress = heard(PlanProgress(1), *(m.MissionItemReached(seq % 65_000) for seq in range(2 * MAX_REACHED)))
    assert len(progress.reached) == MAX_REACHED
