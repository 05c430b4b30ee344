"""The Pi's supply and temperature: what is too hot, what is remembered, and since when it fails."""

from __future__ import annotations

import math

import pytest

from vehicle.params import Params
from vehicle.readings import ComputerReadings
from vehicle.safety.health_notices import CLEAR_DELAY
from vehicle.safety.pi_monitor import TEMPERATURE_HYSTERESIS, PiMonitor
from vehicle.statustext import StatusTextQueue


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
