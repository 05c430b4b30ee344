"""HealthNotices by itself: begin, end, and what is remembered in between."""

from __future__ import annotations

import pytest

from dialects.enums import Severity
from tests.vehicle.bench import said
from tests.vehicle.field import Field
from vehicle.navigation.estimator import GPS_LOST
from vehicle.readings import Readings, SensorFault
from vehicle.safety.health_notices import CLEAR_DELAY, HealthNotices, sensor_notices
from vehicle.statustext import StatusTextQueue


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
