"""The simulated rover over a bad network: it drives, stops at each cut, and drives on only when it is told to."""

from __future__ import annotations

from pathlib import Path

import pytest

from dialects.axes import Axes
from tests.vehicle.ground import Ground, drive, running


@pytest.mark.slow
def test_a_cut_while_driving_stops_the_rover_and_ends(tmp_path: Path) -> None:
    with Ground() as ground, running(tmp_path, "--sim", ground.endpoint, "--cut", "3") as vehicle:
        vehicle.ready()
        drive(ground, vehicle)
        ground.wait(lambda: not vehicle.turning(), "the cut stops the wheels")
        heard = len(ground.heard)
        ground.wait(lambda: len(ground.heard) > heard, "the cut ends")
        ground.demand = Axes()
        drive(ground, vehicle)
