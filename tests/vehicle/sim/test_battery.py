from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from vehicle.sim.battery import REST_VOLTAGES, Battery


def discharge(battery: Battery, current: float, seconds: float) -> None:
    for _ in range(round(seconds / 0.1)):
        battery.step(current, 0.1)


def test_full_and_at_rest() -> None:
    assert Battery().voltage == pytest.approx(12.6)


@pytest.mark.parametrize(("charge", "voltage"), REST_VOLTAGES)
def test_rest_voltage_is_the_table(charge: float, voltage: float) -> None:
    assert Battery(charge).voltage == pytest.approx(voltage)


def test_runs_down_by_its_capacity() -> None:
    battery = Battery(capacity=1.0)
    discharge(battery, 2.0, 900)
    assert battery.remaining == pytest.approx(0.5)
    discharge(battery, 2.0, 2000)
    assert battery.remaining == 0.0
    assert battery.voltage > 0.0


def test_sags_at_once_and_recovers_slowly() -> None:
    battery = Battery(capacity=1000.0)  # so that charge plays no part
    rest = battery.voltage
    battery.step(10.0, 0.001)
    assert battery.voltage == pytest.approx(rest - 0.6, abs=0.01)
    discharge(battery, 10.0, 100)
    assert battery.voltage == pytest.approx(rest - 1.0, abs=0.02)
    battery.step(0.0, 0.001)
    assert battery.voltage == pytest.approx(rest - 0.4, abs=0.02)
    discharge(battery, 0.0, 100)
    assert battery.voltage == pytest.approx(rest, abs=0.02)


@given(st.floats(0, 1), st.lists(st.floats(0, 50), max_size=30))
def test_never_charges_itself(charge: float, currents: list[float]) -> None:
    battery = Battery(charge)
    for current in currents:
        before = battery.remaining
        battery.step(current, 1.0)
        assert 0.0 <= battery.remaining <= before
        assert 0.0 <= battery.voltage <= 12.6
