"""Battery failsafes: each test first shows the wheels turning."""

from __future__ import annotations

import math

from msgspec.structs import replace

from dialects import messages as m
from dialects.enums import Command, DriveLimit, Result
from dialects.modes import Mode
from tests.vehicle.bench import AHEAD, NEUTRAL, Bench, said
from vehicle.readings import Readings


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
