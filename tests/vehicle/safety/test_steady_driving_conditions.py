"""What allows a short cycle, one condition at a time: the demand, the wheels, and the times that run out."""

from __future__ import annotations

import pytest

from dialects.enums import Failsafe
from dialects.modes import Mode
from tests.vehicle.bench import AHEAD, NEUTRAL
from tests.vehicle.pacing import Machine, cruise, idle_machine
from vehicle.drive.demand import Demand
from vehicle.pace import PERIOD
from vehicle.params import Params
from vehicle.safety.battery import BatteryMonitor
from vehicle.safety.steady_driving import SteadyDriving


class Steady:
    """A rover that has been driven ahead for some time, and what decides about its cycles."""

    def __init__(self) -> None:
        self.machine = cruise(idle_machine())
        self.rover = self.machine.rover
        self.decides: SteadyDriving = self.rover._steady
        self.demand = self.rover._control.demand
        assert self.demand is not None

    @property
    def now(self) -> float:
        return self.machine.now

    def lasts(self) -> bool:
        return self.decides.lasts(self.now)

    def repeats(self, before: Demand | None) -> bool:
        return self.decides.repeats(before, self.now)


@pytest.fixture
def steady() -> Steady:
    found = Steady()
    assert found.lasts()
    assert found.repeats(found.demand)
    return found


def test_wheels_that_have_moved_within_the_period(steady: Steady) -> None:
    steady.decides.note_outputs((0.5, 0.5), driven=True, now=0.0)
    steady.rover._monitor.skip_cycle(0.0)
    assert steady.demand is not None
    steady.rover._control.demand = still = steady.demand._replace(time=0.0)
    assert not steady.decides.repeats(still, PERIOD)
    assert not steady.decides.lasts(PERIOD)
    assert steady.decides.lasts(PERIOD + 0.01)
    steady.rover._monitor.skip_cycle(PERIOD)
    assert steady.decides.repeats(still, PERIOD + 0.01)


def test_wheels_that_have_moved_just_now(steady: Steady) -> None:
    steady.decides.note_outputs((0.4, 0.4), driven=True, now=steady.now)
    assert not steady.repeats(steady.demand)
    assert not steady.lasts()


def test_the_same_wheels_again_have_not_moved(steady: Steady) -> None:
    steady.decides.note_outputs(steady.rover._drive.wheels, driven=True, now=steady.now)
    assert steady.lasts()


def test_wheels_that_do_not_follow_the_demand(steady: Steady) -> None:
    steady.decides.note_outputs(steady.rover._drive.wheels, driven=False, now=steady.now)
    assert not steady.repeats(steady.demand)


def test_no_demand_now_or_before(steady: Steady) -> None:
    assert not steady.repeats(None)
    steady.rover._control.demand = None
    assert not steady.repeats(steady.demand)
    assert not steady.repeats(None)
    assert not steady.lasts()


def test_a_demand_of_other_axes(steady: Steady) -> None:
    assert steady.demand is not None
    for other in ({"throttle": 0.25}, {"steering": 0.25}, {"sideways": 0.25}):
        assert not steady.repeats(Demand(**(steady.demand._asdict() | other)))


def test_a_stick_that_was_not_seen_in_neutral(steady: Steady) -> None:
    steady.rover._control.neutral_seen = False
    assert not steady.repeats(steady.demand)


def test_a_late_cycle(steady: Steady) -> None:
    steady.machine.freeze(0.2)
    assert not steady.repeats(steady.demand)


def test_a_demand_that_has_become_stale(steady: Steady) -> None:
    steady.machine.now += 0.46
    assert not steady.lasts()


@pytest.mark.parametrize(
    ("mode", "enough"), [(Mode.MANUAL, True), (Mode.HOLD, True), (Mode.ACRO, False), (Mode.GUIDED, False)]
)
def test_a_mode_that_needs_a_sensor(steady: Steady, mode: Mode, enough: bool) -> None:
    steady.rover._safety.mode = mode
    assert steady.lasts() is enough


def machine(**params: float) -> Machine:
    """A rover that is driven ahead; its times begin with its newest message, at `now`."""
    found = Machine(**{"FS_GCS_ENABLE": 0, "DISARM_DELAY": 0, **params})
    found.wait(3.0)
    found.arm()
    found.wait(0.5, NEUTRAL)
    found.wait(0.5, AHEAD)
    found.stick(AHEAD)
    found._tick()
    return found


def deadline(of: Machine, wait: float) -> bool:
    return of.rover._monitor.has_deadline(of.now + wait)


def test_the_first_time_that_runs_out_counts() -> None:
    lost = machine(FS_GCS_TIMEOUT=5, DISARM_DELAY=20)
    assert [deadline(lost, wait) for wait in (4.99, 5.01)] == [False, True]
    idle = machine(FS_GCS_TIMEOUT=50, DISARM_DELAY=6)
    assert [deadline(idle, wait) for wait in (5.99, 6.01)] == [False, True]
    assert idle.rover._monitor.has_deadline(idle.rover._monitor._quiet_until)


def test_an_absent_operator_counts_while_the_demand_is_motion() -> None:
    away = machine(OPR_TIMEOUT=2, FS_GCS_TIMEOUT=50)
    away.meet()  # with an input just now
    assert [deadline(away, wait) for wait in (1.99, 2.01)] == [False, True]
    away.stick(NEUTRAL)
    assert not deadline(away, 2.01)


def test_the_time_of_a_failsafe_runs() -> None:
    tilted = machine(FS_GCS_TIMEOUT=50)
    tilted.rover._safety.failsafes.update({Failsafe.TILT: tilted.now}, tilted.now)
    assert not tilted.rover._safety.failsafes.quiet
    assert tilted.rover._monitor._find_deadline() < tilted.now


def test_a_voltage_below_a_limit_runs() -> None:
    for limits in ({"BATT_LOW_VOLT": 10.5, "BATT_CRT_VOLT": 0.0}, {"BATT_LOW_VOLT": 0.0, "BATT_CRT_VOLT": 10.5}):
        battery = BatteryMonitor(Params(limits))
        battery.update(10.6, 1.0)
        assert battery.counting is False
        battery.update(10.4, 2.0)
        assert battery.counting is True
    low = machine(FS_GCS_TIMEOUT=50, BATT_LOW_VOLT=10.5)
    assert not deadline(low, 0.1)
    low.rover._safety.battery.update(10.4, low.now)
    assert low.rover._monitor._find_deadline() < low.now
