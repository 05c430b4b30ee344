"""FS_GCS_ENABLE: which modes go on without a ground station."""

from __future__ import annotations

import pytest

from dialects.modes import Mode
from tests.vehicle.bench import AHEAD, said
from tests.vehicle.field import Field


@pytest.mark.parametrize("mode", [Mode.MANUAL, Mode.GUIDED])
def test_only_auto_goes_on_without_a_ground_station_where_the_setting_is_2(mode: Mode) -> None:
    field = Field(FS_GCS_ENABLE=2)
    if mode is Mode.MANUAL:
        field.drive(AHEAD)
    else:
        field.begin(Mode.GUIDED)
        field.goto(100.0, 0.0)
        field.beat(3.0)
    assert field.turning
    field.wait(7.0)
    assert field.mode is Mode.HOLD
    assert not field.turning
    assert said(field, "ground station lost: HOLD")
