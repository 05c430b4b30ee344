"""The periodic safety checks: late control loop and automatic disarming."""

from __future__ import annotations

import pytest

from tests.vehicle.bench import AHEAD, NEUTRAL, Bench, said
from vehicle.drive.gate import Outputs

ZERO = Outputs((0.0, 0.0), enabled=False)


class TestLoop:
    def test_a_late_cycle_zeroes_the_outputs(self) -> None:
        bench = Bench()
        bench.drive()
        bench.freeze(0.15)
        bench.stick(AHEAD)
        assert bench.rover.outputs == ZERO
        bench.cycle()
        assert bench.rover.outputs == ZERO
        assert bench.armed
        bench.wait(0.1, AHEAD)
        assert bench.turning

    @pytest.mark.parametrize("first", ["tick", "demand"])
    def test_a_stalled_control_loop_disarms(self, first: str) -> None:
        """Also when a demand that waited in the socket comes before the first cycle."""
        bench = Bench()
        bench.drive()
        bench.freeze(0.25)
        bench.cycle() if first == "tick" else bench.stick(AHEAD)
        assert bench.rover.outputs == ZERO
        assert not bench.armed
        bench.wait(0.1)
        assert said(bench, "Disarmed: control loop was 0.25 s late")

    def test_the_loop_timeout_is_a_parameter(self) -> None:
        bench = Bench(FS_LOOP_TIMEOUT=1.0)
        bench.drive()
        bench.freeze(0.9)
        bench.cycle()
        assert bench.armed
        assert not bench.turning


class TestIdle:
    def test_an_idle_rover_disarms_after_disarm_delay(self) -> None:
        bench = Bench(DISARM_DELAY=20)
        bench.drive()
        bench.wait(15.0, NEUTRAL, period=0.2)
        assert bench.armed
        bench.wait(6.0, NEUTRAL, period=0.2)
        assert not bench.armed
        assert said(bench, "Disarmed: no demand for 20 s")


def test_a_cycle_that_is_left_out_makes_the_next_one_no_later() -> None:
    monitor = Bench().rover._monitor
    for step in range(50):
        monitor.skip_cycle(100.0 + step)
        assert not monitor.is_late(100.02 + step)
    assert monitor.is_late(150.0)
