"""The thinned line of positions."""

from __future__ import annotations

import pytest

from groundstation.vehicles.readings.track import MAX_POINTS, Track


def test_a_vehicle_that_stands_makes_one_point() -> None:
    track = Track()
    for step in range(100):
        track.add((0.01 * (step % 2), 0.0))
    assert track.points == ((0.0, 0.0),)


def test_a_long_drive_is_thinned_and_keeps_both_ends() -> None:
    track = Track()
    for step in range(20_000):
        track.add((0.15 * step, 0.0))
    assert len(track.points) <= MAX_POINTS
    assert track.points[0] == (0.0, 0.0)
    assert track.points[-1][0] == pytest.approx(3000.0, abs=30)
    gaps = [b[0] - a[0] for a, b in zip(track.points, track.points[1:], strict=False)]
    assert max(gaps) < 4 * min(gaps)
