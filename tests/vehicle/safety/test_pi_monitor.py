"""Under-voltage and overheating of the Pi: each test first shows the wheels turning."""

from __future__ import annotations

import math

import pytest

from dialects import messages as m
from dialects.enums import Command, DriveLimit, Failsafe, Result, SystemState
from dialects.modes import Mode
from tests.vehicle.bench import AHEAD, NEUTRAL, Bench, said
from vehicle.params import Params
from vehicle.readings import ComputerReadings, Readings
from vehicle.safety.health_notices import CLEAR_DELAY
from vehicle.safety.pi_monitor import TEMPERATURE_HYSTERESIS, PiMonitor
from vehicle.statustext import StatusTextQueue


class TestComputer:
    def pi(self, bench: Bench, temperature: float = 50.0, *, weak: bool | None = False) -> None:
        bench.readings = Readings(computer=ComputerReadings(temperature=temperature, under_voltage=weak))
        bench.wait(0.04, AHEAD if bench.turning else None)

    @pytest.mark.parametrize(("temperature", "weak"), [(86.0, False), (50.0, True)])
    def test_half_speed_then_hold_then_half_speed_after_manual(self, temperature: float, weak: bool) -> None:
        bench = Bench()
        bench.drive()
        self.pi(bench, temperature, weak=weak)
        bench.wait(1.0, AHEAD)
        assert bench.throttles == (0.5, 0.5)
        assert said(bench, "Failsafe: Pi under-voltage or too hot: half speed")
        assert bench.newest(m.RoverFailsafeStatus).active == Failsafe.OVERHEAT
        assert bench.newest(m.RoverDriveStatus).limits & DriveLimit.SPEED
        assert not bench.newest(m.RoverDriveStatus).limits & DriveLimit.BATTERY
        bench.wait(8.5, AHEAD)
        assert bench.turning
        bench.wait(1.0, AHEAD)
        assert not bench.turning
        assert bench.mode is Mode.HOLD
        assert bench.newest(m.Heartbeat).system_status == SystemState.CRITICAL
        bench.set_mode(Mode.MANUAL)
        bench.wait(0.1, NEUTRAL)
        bench.wait(1.0, AHEAD)
        assert bench.throttles == (0.5, 0.5)
        self.pi(bench)
        bench.wait(6.0, AHEAD)
        assert bench.throttles == (1.0, 1.0)
        assert said(bench, "Failsafe cleared: Pi under-voltage or too hot")

    def test_intermittent_under_voltage_ends_in_hold(self) -> None:
        bench = Bench()
        bench.drive()
        for cycle in range(12):
            self.pi(bench, weak=cycle % 2 == 0)
            bench.wait(1.0, AHEAD)
        assert bench.mode is Mode.HOLD
        assert sum("half speed" in text for text in bench.texts) <= 1

    def test_a_short_under_voltage_limits_the_speed_briefly(self) -> None:
        bench = Bench()
        bench.drive()
        self.pi(bench, weak=True)
        self.pi(bench)
        bench.wait(4.5, AHEAD)
        assert bench.throttles == (0.5, 0.5)
        bench.wait(1.5, AHEAD)
        assert bench.throttles == (1.0, 1.0)
        bench.wait(20.0, AHEAD)
        assert bench.mode is Mode.MANUAL

    def test_a_missing_reading_does_not_clear_the_condition(self) -> None:
        bench = Bench()
        bench.drive()
        self.pi(bench, weak=True)
        bench.readings = Readings()
        bench.wait(12.0, AHEAD)
        assert bench.mode is Mode.HOLD

    @pytest.mark.parametrize(("act", "throttle", "mode"), [(0, 1.0, Mode.MANUAL), (1, 0.5, Mode.MANUAL)])
    def test_the_action_is_a_parameter(self, act: float, throttle: float, mode: Mode) -> None:
        bench = Bench(FS_PI_ACT=act)
        bench.drive()
        self.pi(bench, 100.0, weak=True)
        bench.wait(30.0, AHEAD)
        assert bench.throttles == (throttle, throttle)
        assert bench.mode is mode
        assert said(bench, "Pi under-voltage")
        assert (bench.newest(m.Heartbeat).system_status == SystemState.CRITICAL) == bool(act)

    @pytest.mark.parametrize(("limit", "throttle"), [(0, 1.0), (95, 1.0), (85, 0.5)])
    def test_the_temperature_limit_is_a_parameter(self, limit: float, throttle: float) -> None:
        bench = Bench(FS_PI_TEMP=limit)
        bench.drive()
        self.pi(bench, 90.0)
        bench.wait(2.0, AHEAD)
        assert bench.throttles == (throttle, throttle)

    def test_arming_takes_force_meanwhile_and_gets_the_full_delay(self) -> None:
        bench = Bench()
        self.pi(bench, 91.0, weak=True)
        bench.wait(60.0)
        assert bench.arm() is Result.FAILED
        bench.wait(0.1)
        assert said(bench, "PreArm: Pi under-voltage and Pi at 91 C")
        assert bench.command(Command.COMPONENT_ARM_DISARM, 1, 21196) is Result.ACCEPTED
        bench.wait(0.1, NEUTRAL)
        bench.wait(9.0, AHEAD)
        assert bench.throttles == (0.5, 0.5)
        bench.wait(1.5, AHEAD)
        assert bench.mode is Mode.HOLD

    def test_a_recovered_supply_allows_arming_at_once(self) -> None:
        bench = Bench(FS_PI_ACT=2)
        self.pi(bench, weak=True)
        assert bench.arm() is Result.FAILED
        self.pi(bench)
        assert bench.arm() is Result.ACCEPTED

    def test_arming_ignores_the_pi_if_the_failsafe_is_disabled(self) -> None:
        bench = Bench(FS_PI_ACT=0)
        self.pi(bench, weak=True)
        assert bench.arm() is Result.ACCEPTED


def monitor(limit: float = 85.0) -> PiMonitor:
    return PiMonitor(Params({"FS_PI_TEMP": limit}), StatusTextQueue())


def at(temperature: float | None = None, *, weak: bool | None = None) -> ComputerReadings:
    return ComputerReadings(temperature=temperature, under_voltage=weak)


def test_too_hot_above_the_limit_and_until_five_degrees_below() -> None:
    assert TEMPERATURE_HYSTERESIS == 5.0
    pi = monitor()
    pi.update(at(85.0), 1.0)
    assert (pi.problem(), pi.failing_since()) == (None, None)
    pi.update(at(85.1), 2.0)
    assert (pi.problem(), pi.failing_since()) == ("Pi at 85 C", 2.0)
    pi.update(at(80.1), 20.0)
    assert pi.problem() == "Pi at 80 C"
    pi.update(at(80.0), 21.0)
    assert pi.problem() is None
    assert pi.failing_since() == 2.0
    pi.update(at(80.0), 20.0 + CLEAR_DELAY)
    assert pi.failing_since() is None


@pytest.mark.parametrize(("limit", "hot"), [(0.0, False), (0.5, True), (110.0, False)])
def test_the_limit_is_a_parameter_and_zero_is_off(limit: float, hot: bool) -> None:
    pi = monitor(limit)
    pi.update(at(100.0), 1.0)
    assert (pi.problem() is not None) is hot


def test_a_weak_supply_and_heat_are_reported_together_once() -> None:
    pi = monitor()
    pi.update(at(90.0, weak=False), 1.0)
    pi.update(at(90.0, weak=True), 2.0)
    problem = pi.problem()
    assert problem is not None
    assert problem.split(" and ")[::-1] == ["Pi at 90 C", "Pi under-voltage"]
    assert pi.failing_since() == 1.0


@pytest.mark.parametrize("unknown", [None, at(), at(math.nan), at(math.inf)])
def test_an_unknown_value_stays_as_it_was(unknown: ComputerReadings | None) -> None:
    pi = monitor()
    pi.update(unknown, 0.0)
    assert pi.problem() is None
    pi.update(at(90.0, weak=True), 1.0)
    before = pi.problem()
    pi.update(unknown, 100.0)
    assert pi.problem() is not None
    assert set((pi.problem() or "").split(" and ")) == set((before or "").split(" and "))
    assert pi.failing_since() == 1.0


def test_one_of_them_known_does_not_end_the_other() -> None:
    pi = monitor()
    pi.update(at(90.0, weak=True), 1.0)
    pi.update(at(None, weak=False), 2.0)
    assert pi.problem() == "Pi at 90 C"
    pi.update(at(20.0), 3.0)
    assert pi.problem() is None
