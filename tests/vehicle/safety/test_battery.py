"""Battery failsafes: each test first shows the wheels turning."""

from __future__ import annotations

import math

import pytest
from msgspec.structs import replace

from dialects import messages as m
from dialects.enums import Command, DriveLimit, Result
from dialects.modes import Mode
from tests.vehicle.bench import AHEAD, NEUTRAL, Bench, said
from vehicle.params import Params
from vehicle.readings import Readings
from vehicle.safety.battery import CRITICAL_TIMER, SENSOR_TIMEOUT, BatteryMonitor


class TestBattery:
    def drained(self, bench: Bench, voltage: float) -> None:
        bench.readings = replace(bench.readings, battery_voltage=voltage)

    def test_low_holds_and_then_allows_half_speed(self) -> None:
        bench = Bench()
        self.drained(bench, 12.0)
        bench.drive()
        self.drained(bench, 10.4)
        bench.wait(9.0, AHEAD)
        assert bench.throttles == (1.0, 1.0)
        bench.wait(1.5, AHEAD)
        assert not bench.turning
        assert bench.mode is Mode.HOLD
        assert said(bench, "battery low: HOLD")
        bench.set_mode(Mode.MANUAL)
        bench.wait(0.1, NEUTRAL)
        bench.wait(1.0, AHEAD)
        assert bench.throttles == (0.5, 0.5)
        assert bench.newest(m.RoverDriveStatus).limits & DriveLimit.BATTERY

    def test_low_can_be_set_to_slow_down_only(self) -> None:
        bench = Bench(FS_LOW_ACT=0)
        bench.drive()
        self.drained(bench, 10.4)
        bench.wait(11.0, AHEAD)
        assert bench.throttles == (0.5, 0.5)

    def test_a_short_voltage_sag_is_ignored(self) -> None:
        bench = Bench()
        bench.drive()
        for _ in range(5):
            self.drained(bench, 9.0)
            bench.wait(2.5, AHEAD)
            self.drained(bench, 11.0)
            bench.wait(0.5, AHEAD)
        assert bench.throttles == (1.0, 1.0)

    def test_critical_holds_blocks_modes_and_disarms(self) -> None:
        bench = Bench()
        bench.drive()
        self.drained(bench, 9.5)
        bench.wait(3.5, AHEAD)
        assert not bench.turning
        assert bench.mode is Mode.HOLD
        assert bench.set_mode(Mode.MANUAL) is Result.FAILED
        assert bench.set_mode(Mode.HOLD) is Result.ACCEPTED
        bench.wait(9.8, NEUTRAL)
        assert not bench.armed

    def test_arming_by_force_gets_the_full_delay(self) -> None:
        bench = Bench()
        self.drained(bench, 9.0)
        bench.wait(60.0)
        assert bench.command(Command.COMPONENT_ARM_DISARM, 1, 21196) is Result.ACCEPTED
        bench.wait(0.5, NEUTRAL)
        assert bench.mode is Mode.HOLD
        bench.wait(9.0, NEUTRAL)
        assert bench.armed
        bench.wait(1.0, NEUTRAL)
        assert not bench.armed

    def test_without_a_sensor_there_is_no_failsafe(self) -> None:
        bench = Bench()
        bench.readings = Readings(battery_voltage=math.nan)
        bench.drive()
        bench.wait(15.0, AHEAD)
        assert bench.throttles == (1.0, 1.0)


PARAMS = Params({"BATT_LOW_VOLT": 10.5, "BATT_CRT_VOLT": 10.0, "BATT_LOW_TIMER": 10.0})


def monitor(voltage: float | None, *times: float, expected: bool = False) -> BatteryMonitor:
    """With a reading of `voltage` at each of `times`."""
    battery = BatteryMonitor(PARAMS)
    for now in times:
        battery.update(voltage, now, expected=expected)
    return battery


@pytest.mark.parametrize(("voltage", "low"), [(10.49, True), (10.5, False), (12.0, False)])
def test_low_begins_after_its_timer_and_below_its_voltage(voltage: float, low: bool) -> None:
    battery = monitor(voltage, 100.0, 105.0)
    assert battery.low_since(109.99) is None
    assert battery.low_since(110.0) == (110.0 if low else None)
    assert battery.low_since(115.0) == (110.0 if low else None)
    assert battery.critical_since(115.0) is None


@pytest.mark.parametrize(("voltage", "critical"), [(9.99, True), (10.0, False)])
def test_critical_begins_after_three_seconds(voltage: float, critical: bool) -> None:
    assert CRITICAL_TIMER == 3.0
    battery = monitor(voltage, 100.0, 101.0)
    assert battery.critical_since(102.99) is None
    assert battery.critical_since(103.0) == (103.0 if critical else None)


def test_a_good_voltage_restarts_the_time() -> None:
    battery = monitor(9.0, 100.0)
    battery.update(12.0, 109.0)
    battery.update(9.0, 110.0)
    assert battery.low_since(119.0) is None
    assert battery.low_since(120.0) == 120.0


@pytest.mark.parametrize("voltage", [None, math.nan, math.inf, -math.inf])
def test_what_is_no_reading_changes_nothing(voltage: float | None) -> None:
    battery = monitor(9.0, 100.0)
    battery.update(voltage, 101.0)
    assert battery.low_since(110.0) == 110.0
    assert battery.critical_since(103.0) == 103.0
    assert not battery.is_silent(105.0)
    assert battery.is_silent(105.01)
    assert not monitor(voltage, 100.0).present
    assert not monitor(voltage, 100.0).is_silent(200.0)


def test_a_sensor_is_silent_after_five_seconds() -> None:
    assert SENSOR_TIMEOUT == 5.0
    battery = monitor(12.0, 100.0)
    assert battery.present
    assert not battery.is_silent(105.0)
    assert battery.is_silent(105.01)


def test_an_expected_sensor_is_silent_from_the_beginning() -> None:
    battery = BatteryMonitor(PARAMS)
    assert (battery.present, battery.is_silent(0.0)) == (False, False)
    battery.update(None, 0.0)
    assert (battery.present, battery.is_silent(0.0)) == (False, False)
    battery.update(None, 0.0, expected=True)
    assert (battery.present, battery.is_silent(0.0)) == (True, True)
    battery.update(12.0, 1.0, expected=True)
    assert (battery.present, battery.is_silent(1.0)) == (True, False)
    battery.update(None, 2.0)
    assert battery.present
