"""AUTO in a simulated field: relays and servos of a plan act when their turn comes."""

from __future__ import annotations

import pytest

from dialects import messages as m
from dialects.enums import Command, Failsafe, FenceItem, MissionResult, MissionType
from dialects.modes import Mode
from tests.vehicle.bench import Equipped, said
from tests.vehicle.field import Field
from tests.vehicle.missions import Item, do, finish, start, upload, way
from vehicle.navigation.geo import Point

RELAY, SERVO = Command.DO_SET_RELAY, Command.DO_SET_SERVO


class EquippedField(Field):
    outputs = Equipped.outputs

    @property
    def relays(self) -> dict[int, int]:
        return self.rack.values("relay")

    @property
    def servo(self) -> int:
        return self.rack.values("servo")[9]


def ready(*items: Item) -> EquippedField:
    field = EquippedField()
    assert upload(field, *items) == MissionResult.ACCEPTED
    field.arm()
    return field


def test_each_acts_when_its_turn_comes_and_not_before() -> None:
    field = ready(
        way(4, 0), do(RELAY, 0, 1), do(SERVO, 9, 1700), way(8, 0), do(RELAY, 0, 0), do(SERVO, 9, 1200), way(12, 0)
    )
    field.beat(1.0)
    assert (field.relays[0], field.servo) == (0, 0)
    start(field)
    field.beat(1.0)
    assert field.turning
    assert (field.relays[0], field.servo) == (0, 0)
    field.until(Point(6, 0), 40.0, 1.0)
    assert (field.relays[0], field.servo) == (1, 1700)
    assert field.newest(m.RelayStatus).on == 1
    field.until(Point(10, 0), 40.0, 1.0)
    assert (field.relays[0], field.servo) == (0, 1200)
    finish(field, 40.0)
    assert not said(field, "skipped")
    assert not said(field, "no accessory")


def test_a_delay_holds_up_what_stands_behind_it() -> None:
    field = ready(do(Command.CONDITION_DELAY, 3), do(RELAY, 0, 1), way(20, 0))
    start(field)
    field.beat(2.0)
    assert field.relays[0] == 0
    field.beat(2.0)
    assert field.relays[0] == 1


def test_what_stands_behind_the_last_place_acts_there() -> None:
    field = ready(do(RELAY, 0, 1), way(3, 0), do(RELAY, 0, 0), do(SERVO, 9, 1300))
    start(field)
    field.until(Point(2, 0), 20.0, 1.0)
    assert (field.relays[0], field.servo) == (1, 0)
    finish(field, 30.0)
    field.wait(0.1)
    assert (field.relays[0], field.servo) == (0, 1300)
    assert said(field, "mission complete")


def test_what_stands_before_a_place_that_is_refused_does_not_act() -> None:
    fence = (FenceItem.CIRCLE_INCLUSION, Point(0, 0), (10,))
    field = EquippedField(FENCE_ENABLE=1)
    assert upload(field, fence, kind=MissionType.FENCE) == MissionResult.ACCEPTED
    assert upload(field, way(3, 0), do(RELAY, 0, 1), way(20, 0)) == MissionResult.ACCEPTED
    field.arm()
    start(field)
    field.until(Point(2, 0), 30.0, 1.0)
    finish(field, 30.0)
    field.wait(0.5)
    assert said(field, "AUTO: item 2: outside the fence: HOLD")
    assert field.relays[0] == 0


def test_jumps_in_a_circle_wear_no_relay_out() -> None:
    field = ready(do(Command.DO_REPEAT_RELAY, 0, 1, 1), do(Command.DO_JUMP, 0, -1))
    start(field)
    field.wait(0.5)
    assert said(field, "endless loop of DO_JUMP")
    assert field.relays[0] == 0
    assert not field.all(m.MissionItemReached)


def test_a_repeat_goes_on_while_the_rover_drives_on() -> None:
    field = ready(do(Command.DO_REPEAT_RELAY, 0, 2, 1), do(Command.DO_REPEAT_SERVO, 9, 1800, 2, 1), way(20, 0))
    start(field)
    seen = []
    for _ in range(5):
        field.beat(0.5)
        seen.append((field.relays[0], field.servo))
        field.beat(0.5)
        assert field.turning
    assert seen == [(1, 1800), (0, 1500), (1, 1800), (0, 1500), (0, 1500)]


@pytest.mark.parametrize(
    ("item", "why"),
    [
        (do(RELAY, 7, 1), "there is no relay 7"),
        (do(SERVO, 10, 1500), "there is no servo 10"),
        (do(SERVO, 9, 2500), "2500 us is not 1100 to 1900"),
        (do(Command.DO_REPEAT_RELAY, 7, 1, 1), "there is no relay 7"),
    ],
)
def test_items_the_vehicle_lacks_are_named_at_upload_and_skipped(item: Item, why: str) -> None:
    field = ready(way(2, 0), item, do(RELAY, 0, 1), way(4, 0))
    field.wait(0.2)
    assert said(field, f"Mission: no accessory for items 1, will be skipped: {why}")
    start(field)
    finish(field, 40.0)
    field.wait(0.5)
    assert said(field, f"Mission: skipped {Command(item[0]).name} {item[2][0]:g}: {why}")
    assert field.relays == {0: 1, 1: 0, 2: 0}
    assert field.truth.distance(Point(4, 0)) < 0.7


def test_what_may_not_act_now_is_passed_over_in_words() -> None:
    field = ready(way(3, 0), do(RELAY, 2, 1), way(6, 0))
    start(field)
    field.beat(0.5)
    field.rover._safety.failsafes.latched |= Failsafe.GCS_LOSS  # as after RTL, where AUTO was not chosen anew
    finish(field, 40.0)
    field.wait(0.5)
    assert field.relays[2] == 0
    assert said(field, "Mission: skipped DO_SET_RELAY 2: failsafe")


def test_a_stop_leaves_what_it_has_and_goes_on_with_nothing() -> None:
    field = ready(do(RELAY, 0, 1), way(10, 0), do(RELAY, 1, 1), way(20, 0))
    start(field)
    field.beat(2.0)
    assert field.relays[0] == 1
    field.set_mode(Mode.HOLD)
    field.beat(20.0)
    assert field.relays == {0: 1, 1: 0, 2: 0}
