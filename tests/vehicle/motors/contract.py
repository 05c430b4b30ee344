"""What every motor driver must pass: its test subclasses MotorsContract and gives the fixture `bench`, nothing else."""

from __future__ import annotations

import contextlib
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import pytest

from vehicle.motors import MotorError, Motors


@dataclass
class Bench:
    """A driver on the bench, with something that looks at its wires."""

    motors: Motors
    outputs: Callable[[], Sequence[float]]
    """What each motor really gets, -1..1."""
    enabled: Callable[[], bool]
    """Power is there."""
    tolerance: float = 1e-9
    """How coarse the hardware is."""

    def neutral(self) -> bool:
        """No motor gets anything."""
        return all(abs(output) <= self.tolerance for output in self.outputs())

    def turning(self, throttles: Sequence[float]) -> bool:
        """Each motor gets what it was given."""
        return list(self.outputs()) == pytest.approx(list(throttles), abs=self.tolerance)


class MotorsContract:
    """Subclass it, name the class Test..., and give the fixture `bench`."""

    @pytest.fixture
    def bench(self) -> Bench:
        raise NotImplementedError

    def ahead(self, bench: Bench) -> list[float]:
        """Different for each motor, so that a mix-up shows."""
        return [0.5 - 0.2 * index for index in range(bench.motors.count)]

    def drive(self, bench: Bench) -> None:
        """The danger that each stop must end: without it a stop test proves nothing."""
        bench.motors.enable()
        bench.motors.set(self.ahead(bench))
        assert bench.enabled()
        assert bench.turning(self.ahead(bench))

    def test_is_silent_when_opened(self, bench: Bench) -> None:
        assert bench.neutral()
        assert not bench.enabled()

    def test_turns_each_motor_both_ways(self, bench: Bench) -> None:
        self.drive(bench)
        for throttle in (1.0, -1.0, 0.0):
            bench.motors.set([throttle] * bench.motors.count)
            assert bench.turning([throttle] * bench.motors.count)

    def test_is_neutral_until_it_is_enabled(self, bench: Bench) -> None:
        bench.motors.set(self.ahead(bench))
        assert bench.neutral()

    def test_starts_from_neutral_whatever_was_set_before(self, bench: Bench) -> None:
        bench.motors.set(self.ahead(bench))
        bench.motors.enable()
        assert bench.enabled()
        assert bench.neutral()

    def test_enabled_again_goes_on(self, bench: Bench) -> None:
        self.drive(bench)
        bench.motors.enable()
        assert bench.turning(self.ahead(bench))

    def test_disable_stops_and_forgets(self, bench: Bench) -> None:
        self.drive(bench)
        bench.motors.disable()
        assert bench.neutral()
        assert not bench.enabled()
        bench.motors.enable()
        assert bench.neutral()

    def test_disable_may_come_twice(self, bench: Bench) -> None:
        self.drive(bench)
        bench.motors.disable()
        bench.motors.disable()
        assert not bench.enabled()

    def test_close_stops_and_may_come_twice(self, bench: Bench) -> None:
        self.drive(bench)
        bench.motors.close()
        assert bench.neutral()
        assert not bench.enabled()
        bench.motors.close()
        assert bench.neutral()

    def test_is_neutral_after_an_exception(self, bench: Bench) -> None:
        def drive_and_fail() -> None:
            with contextlib.closing(bench.motors):
                self.drive(bench)
                raise RuntimeError("somewhere else")

        with pytest.raises(RuntimeError, match="somewhere else"):
            drive_and_fail()
        assert bench.neutral()
        assert not bench.enabled()

    @pytest.mark.parametrize("bad", [math.nan, math.inf, -math.inf, 1.0001, -1.0001, 1e30])
    def test_refuses_a_bad_throttle_and_changes_no_motor(self, bench: Bench, bad: float) -> None:
        self.drive(bench)
        for index in range(bench.motors.count):
            throttles = [-0.5] * bench.motors.count
            throttles[index] = bad
            with pytest.raises(MotorError, match="outside"):
                bench.motors.set(throttles)
            assert bench.turning(self.ahead(bench))

    def test_refuses_a_wrong_count_and_changes_no_motor(self, bench: Bench) -> None:
        self.drive(bench)
        for count in (0, bench.motors.count - 1, bench.motors.count + 1):
            with pytest.raises(MotorError, match="motors"):
                bench.motors.set([0.1] * count)
            assert bench.turning(self.ahead(bench))
