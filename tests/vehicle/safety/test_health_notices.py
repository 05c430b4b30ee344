"""Notices about sensors and the Pi: one when a problem begins, one when it ends."""

from __future__ import annotations

import math

import pytest
from msgspec.structs import replace

from dialects import messages as m
from dialects.enums import Severity
from tests.vehicle.bench import AHEAD, EVERYTHING, Bench, said
from tests.vehicle.field import Field
from vehicle.navigation.estimator import GPS_LOST
from vehicle.readings import ComputerReadings, Readings, SensorFault
from vehicle.safety.health_notices import CLEAR_DELAY, HealthNotices, sensor_notices
from vehicle.statustext import StatusTextQueue

NO_CHIP = replace(EVERYTHING, faults=(SensorFault("battery", "no chip at 0x40"),))


def after(bench: Bench, readings: Readings, seconds: float) -> list[str]:
    """Texts of a while with these readings."""
    count = len(bench.texts)
    bench.readings = readings
    bench.wait(seconds)
    return bench.texts[count:]


def pi(temperature: float | None = None, under_voltage: bool | None = None) -> Readings:
    return replace(EVERYTHING, computer=ComputerReadings(temperature=temperature, under_voltage=under_voltage))


def test_the_start_and_end_of_a_sensor_fault_are_reported_once() -> None:
    bench = Bench()
    assert after(bench, EVERYTHING, 10.0) == []
    assert after(bench, NO_CHIP, 60.0) == ["battery sensor: no chip at 0x40"]
    assert bench.newest(m.StatusText).severity == Severity.WARNING
    assert after(bench, EVERYTHING, 4.9) == []
    assert after(bench, EVERYTHING, 60.0) == ["battery sensor OK again"]
    assert bench.newest(m.StatusText).severity == Severity.INFO
    assert after(bench, NO_CHIP, 1.0) == ["battery sensor: no chip at 0x40"]


def test_an_intermittent_fault_is_reported_once() -> None:
    bench = Bench()
    texts = []
    for number in range(20):
        texts += after(bench, NO_CHIP if number % 2 else EVERYTHING, 1.0)
    assert texts == ["battery sensor: no chip at 0x40"]


def test_a_fault_with_another_text_is_the_same_problem() -> None:
    bench = Bench()
    after(bench, NO_CHIP, 10.0)
    assert after(bench, replace(NO_CHIP, faults=(SensorFault("battery", "no reply"),)), 10.0) == []


def test_each_sensor_has_its_own_notice() -> None:
    bench = Bench()
    both = (SensorFault("battery", "no chip"), SensorFault("gps", "no gpsd"))
    assert after(bench, replace(EVERYTHING, faults=both), 10.0) == ["battery sensor: no chip", "gps sensor: no gpsd"]
    assert after(bench, replace(EVERYTHING, faults=both[:1]), 10.0) == ["gps sensor OK again"]


def test_under_voltage_is_reported() -> None:
    bench = Bench()
    assert after(bench, pi(under_voltage=False), 10.0) == []
    assert after(bench, pi(under_voltage=True), 10.0) == ["Pi under-voltage"]
    unwatched = replace(EVERYTHING, computer=None)
    assert after(bench, unwatched, 10.0) + after(bench, pi(), 10.0) == []  # unknown: not over
    assert after(bench, pi(under_voltage=False), 10.0) == ["Pi supply OK again"]


def test_overheating_ends_with_hysteresis() -> None:
    bench = Bench()
    assert after(bench, pi(85.0), 10.0) == []
    assert after(bench, pi(86.0), 10.0) == ["Pi at 86 C"]
    assert after(bench, pi(82.0), 10.0) == []
    assert after(bench, pi(79.0), 10.0) == ["Pi temperature OK again"]
    assert after(bench, pi(82.0), 10.0) == []


@pytest.mark.parametrize("temperature", [None, math.nan, math.inf, -math.inf, -1e300])
def test_no_temperature_stops_the_rover(temperature: float | None) -> None:
    bench = Bench()
    bench.readings = pi(temperature)
    bench.drive()
    bench.wait(30.0, AHEAD)
    assert bench.throttles == (1.0, 1.0)
    assert not said(bench, "Pi at")


def test_a_notice_lasts_until_it_has_been_gone_for_five_seconds() -> None:
    assert CLEAR_DELAY == 5.0
    reported: list[tuple[Severity, str]] = []
    notices = HealthNotices(StatusTextQueue(lambda severity, text: reported.append((severity, text))))
    notices.update({}, 1.0)
    assert (notices.since, reported) == ({}, [])
    notices.update({"GPS": "GPS: no data"}, 2.0)
    assert reported == [(Severity.WARNING, "GPS: no data")]
    notices.update({"GPS": "GPS: other words"}, 10.0)
    notices.update({}, 14.9)
    assert notices.since == {"GPS": 2.0}
    notices.update({"GPS": "GPS: no data"}, 14.95)
    notices.update({}, 19.9)
    assert notices.since == {"GPS": 2.0}
    assert len(reported) == 1
    notices.update({}, 19.95)
    assert notices.since == {}
    assert [severity for severity, _ in reported] == [Severity.WARNING, Severity.INFO]
    notices.update({"GPS": "GPS: no data"}, 30.0)
    assert notices.since == {"GPS": 30.0}


def test_the_end_is_reported_at_five_seconds_and_not_before() -> None:
    notices = HealthNotices(StatusTextQueue())
    notices.update({"GPS": "GPS: no data"}, 10.0)
    notices.update({}, 14.99)
    assert notices.since == {"GPS": 10.0}
    notices.update({}, 15.0)
    assert notices.since == {}


@pytest.mark.parametrize("enabled", [0, 1])
def test_a_fence_without_a_position_is_reported_where_it_counts(enabled: float) -> None:
    field = Field(FENCE_ENABLE=enabled, FENCE_TYPE=2)
    field.wait(10.0)
    field.texts.clear()
    field.blind = {"gps_fix": 0, "latitude": None, "longitude": None}
    field.wait(GPS_LOST + 2.0)
    assert said(field, "Fence not enforced") == bool(enabled)


def test_a_sensors_fault_is_named_by_its_sensor() -> None:
    assert sensor_notices(Readings()) == {}
    assert list(sensor_notices(Readings(faults=(SensorFault("gps", "no data"),)))) == ["gps sensor"]
