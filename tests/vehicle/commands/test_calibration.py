"""PREFLIGHT_CALIBRATION of the gyro: a command that takes a while."""

from __future__ import annotations

import math

import pytest
from msgspec.structs import replace

from dialects import messages as m
from dialects.enums import Command, Result
from tests.vehicle.bench import DRIVER, EVERYTHING, OTHER, Bench, said
from vehicle.commands.calibration import SECONDS
from vehicle.navigation.estimator import BIAS_MAX

CALIBRATE = Command.PREFLIGHT_CALIBRATION
BIAS = 0.03


def at_rest(rate: float | None = BIAS) -> Bench:
    """Without a compass, so that nothing else teaches the bias."""
    bench = Bench()
    bench.readings = replace(EVERYTHING, yaw_rate=rate, yaw=None, velocity_north=0.0, velocity_east=0.0)
    bench.heartbeat()
    bench.wait(0.5)
    return bench


def turn_rate(bench: Bench) -> float:
    rate = bench.rover._navigator.estimate.yaw_rate
    assert rate is not None
    return rate


def verdicts(bench: Bench) -> list[m.CommandAck]:
    return [each for each in bench.all(m.CommandAck) if each.command == CALIBRATE]


def test_the_bias_is_gone_and_the_way_there_is_told() -> None:
    bench = at_rest()
    assert turn_rate(bench) == pytest.approx(BIAS)
    assert bench.command(CALIBRATE, 1) is Result.IN_PROGRESS
    bench.wait(SECONDS + 0.1)
    *news, verdict = verdicts(bench)
    assert {each.result for each in news} == {Result.IN_PROGRESS}
    percents = [each.progress for each in news]
    assert len(news) >= 5
    assert percents == sorted(set(percents))
    assert percents[-1] < 100
    assert verdict.result == Result.ACCEPTED
    assert turn_rate(bench) == pytest.approx(0.0, abs=1e-6)
    assert said(bench, "Gyro calibration: 3 s without moving")
    assert said(bench, "Gyro calibrated: bias 1.72 deg/s")


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"yaw_rate": 0.4}, "the rover moves"),
        ({"yaw_rate": None}, "there is no gyro"),
        ({"yaw_rate": math.nan}, "there is no gyro"),
        ({"yaw_rate": math.inf}, "there is no gyro"),
    ],
)
def test_what_comes_between_ends_it_and_changes_nothing(change: dict[str, float | None], words: str) -> None:
    bench = at_rest()
    rest = bench.readings
    assert bench.command(CALIBRATE, 1) is Result.IN_PROGRESS
    bench.wait(1.0)
    bench.readings = replace(rest, **change)
    bench.wait(0.1)
    assert verdicts(bench)[-1].result == Result.FAILED
    assert said(bench, f"Gyro calibration failed: {words}")
    bench.readings = rest
    bench.wait(SECONDS)
    assert turn_rate(bench) == pytest.approx(BIAS)


def test_one_that_turns_all_the_while_is_no_bias() -> None:
    bench = at_rest(2 * BIAS_MAX)
    bench.command(CALIBRATE, 1)
    bench.wait(SECONDS + 0.1)
    assert verdicts(bench)[-1].result == Result.FAILED
    assert turn_rate(bench) == pytest.approx(2 * BIAS_MAX)


def test_arming_ends_it() -> None:
    bench = at_rest()
    bench.command(CALIBRATE, 1)
    assert bench.arm() is Result.ACCEPTED
    bench.wait(0.1)
    assert verdicts(bench)[-1].result == Result.FAILED
    assert bench.command(CALIBRATE, 1) is Result.TEMPORARILY_REJECTED


def test_anybody_may_cancel_it_and_one_at_a_time() -> None:
    bench = at_rest()
    bench.command(CALIBRATE, 1)
    bench.wait(0.2)
    bench.heartbeat(OTHER)
    assert bench.command(CALIBRATE, 1, system=OTHER) is Result.TEMPORARILY_REJECTED
    bench.say(m.CommandCancel(1, 1, CALIBRATE), OTHER)
    told = {each.target_system: each.result for each in verdicts(bench)}
    assert told == {DRIVER: Result.CANCELLED, OTHER: Result.CANCELLED}
    bench.wait(SECONDS)
    assert turn_rate(bench) == pytest.approx(BIAS)
    assert bench.command(CALIBRATE, 1) is Result.IN_PROGRESS
