"""One relay or servo in time: repeats, failures, its safe value."""

from __future__ import annotations

import pytest

from vehicle.accessories.accessory_set import AccessorySet
from vehicle.accessories.output import RETRY_INTERVAL, AccessoryOutput, AccessorySpec, PulseRange
from vehicle.accessories.simulated import SimulatedAccessory


class Flaky(SimulatedAccessory):
    """Fails so often."""

    def __init__(self, value: int) -> None:
        super().__init__(value)
        self.failures = 0
        self.tries = 0

    def set(self, value: int) -> None:
        self.tries += 1
        if self.failures:
            self.failures -= 1
            raise OSError(121, "Remote I/O error")
        super().set(value)


def relay(**settings: object) -> tuple[AccessoryOutput, list[Flaky]]:
    made: list[Flaky] = []

    def make(value: int) -> Flaky:
        made.append(Flaky(value))
        return made[-1]

    outlet = AccessoryOutput(AccessorySpec("relay", 0, make, **settings))  # type: ignore[arg-type]
    outlet.open()
    return outlet, made


def servo() -> AccessoryOutput:
    outlet = AccessoryOutput(AccessorySpec("servo", 9, SimulatedAccessory, pulses=PulseRange(1000, 1400, 2000)))
    outlet.open()
    return outlet


def changes(outlet: AccessoryOutput, until: float, period: float = 0.02) -> list[tuple[float, int]]:
    """When it gave what."""
    found: list[tuple[float, int]] = []
    now = 0.0
    while now < until:
        before = outlet.actual
        outlet.update(now)
        if outlet.actual is not None and outlet.actual != before:
            found.append((round(now, 3), outlet.actual))
        now = round(now + period, 6)
    return found


def test_a_repeat_goes_there_and_back_so_often() -> None:
    outlet, _ = relay()
    outlet.start_repeat(None, 2, 0.5, 0.0)
    assert changes(outlet, 5.0) == [(0.0, 1), (0.5, 0), (1.0, 1), (1.5, 0)]


def test_a_relay_that_is_on_goes_off_and_back() -> None:
    outlet, _ = relay(start=1)
    outlet.start_repeat(None, 1, 0.5, 0.0)
    assert changes(outlet, 5.0) == [(0.0, 0), (0.5, 1)]


def test_a_servo_comes_back_to_its_trim() -> None:
    outlet = servo()
    outlet.start_repeat(1900, 2, 1.0, 0.0)
    assert changes(outlet, 9.0) == [(0.0, 1900), (1.0, 1400), (2.0, 1900), (3.0, 1400)]


def test_another_wish_ends_a_repeat() -> None:
    outlet = servo()
    outlet.start_repeat(1900, 100, 0.2, 0.0)
    assert len(changes(outlet, 1.0)) == 5
    outlet.set_value(1100)
    assert changes(outlet, 5.0) == [(0.0, 1100)]


def test_repeat_in_place_of_a_repeat_ends_where_the_first_began() -> None:
    outlet, _ = relay()
    outlet.start_repeat(None, 9, 0.5, 0.0)
    changes(outlet, 0.3)
    assert outlet.actual == 1
    outlet.start_repeat(None, 1, 0.5, 0.0)
    assert changes(outlet, 5.0) == [(0.5, 0)]


def test_a_loop_that_stood_still_makes_up_for_nothing() -> None:
    outlet, made = relay()
    outlet.start_repeat(None, 3, 0.5, 0.0)
    outlet.update(0.0)
    for _ in range(3):
        outlet.update(60.0)
    assert made[0].tries == 2


def test_a_failure_is_kept_and_tried_again() -> None:
    outlet, [made] = relay()
    made.failures = 2
    outlet.set_value(1)
    assert not outlet.update(0.0)
    assert outlet.fault == "[Errno 121] Remote I/O error"
    assert outlet.actual == 0
    assert outlet.update(RETRY_INTERVAL / 2)
    assert made.tries == 1
    assert not outlet.update(RETRY_INTERVAL)
    assert outlet.update(2 * RETRY_INTERVAL)
    assert outlet.fault is None
    assert (outlet.actual, made.value) == (1, 1)


def test_what_is_asked_for_last_counts_when_it_works_again() -> None:
    outlet, [made] = relay()
    made.failures = 1
    outlet.set_value(1)
    outlet.update(0.0)
    outlet.set_value(0)
    assert changes(outlet, RETRY_INTERVAL + 0.1) == []
    assert (outlet.fault, made.value, made.tries) == (
        None,
        0,
        2,
    )  # again, for it may have done what it said it could not


def test_close_makes_it_safe_first() -> None:
    outlet, [made] = relay(start=0, safe=1)
    outlet.start_repeat(None, 9, 0.5, 0.0)
    outlet.update(0.0)
    outlet.close()
    assert made.value == 1
    assert outlet.actual is None
    outlet.update(9.0)
    assert made.value == 1


def test_an_output_that_does_not_open_keeps_its_reason() -> None:
    def make(value: int) -> Flaky:
        raise OSError("no such bus")

    outlet = AccessoryOutput(AccessorySpec("servo", 9, make))
    outlet.open()
    outlet.set_value(1500)
    assert outlet.update(0.0)
    assert (outlet.fault, outlet.actual) == ("no such bus", None)
    outlet.close()
    assert AccessorySet([outlet.spec]).values("servo") == {}


def test_a_dead_bus_costs_one_try_in_a_cycle() -> None:
    made: list[Flaky] = []

    def make(value: int) -> Flaky:
        made.append(Flaky(value))
        made[-1].failures = 99
        return made[-1]

    rack = AccessorySet(AccessorySpec("relay", number, make) for number in range(8))
    rack.open()
    for outlet in rack:
        outlet.set_value(1)
    for cycle in range(8):
        rack.update(lambda until: None, cycle * 0.02)
        assert sum(each.tries for each in made) == cycle + 1


@pytest.mark.parametrize(("kind", "number", "there"), [("relay", 0, True), ("relay", 1, False), ("servo", 0, False)])
def test_a_rack_finds_by_kind_and_number(kind: str, number: float, there: bool) -> None:
    rack = AccessorySet([AccessorySpec("relay", 0, SimulatedAccessory)])
    assert (rack.find(kind, number) is not None) is there
