"""The speed readout."""

from __future__ import annotations

import math

import pytest

from groundstation.ui.drive.instruments.speed import speed_text
from tests.groundstation.ui.examples import vehicle


@pytest.mark.parametrize(
    ("speed", "shown"),
    [
        (0.84, " 0.84"), (-0.84, "-0.84"), (-0.001, " 0.00"), (12.345, "12.35"), (-1e9, "-9.99"), (math.nan, " -.--"),
        (None, " -.--"),
    ],
)  # fmt: skip
def test_the_speed_keeps_its_width(speed: float | None, shown: str) -> None:
    assert speed_text(vehicle(speed=speed)) == shown
