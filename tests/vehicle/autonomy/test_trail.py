"""The trail of SMART_RTL."""

from __future__ import annotations

from vehicle.autonomy.trail import TRAIL_MAX, Trail
from vehicle.navigation.geo import Point


def test_loops_are_removed_and_a_long_trail_gets_coarser() -> None:
    trail = Trail()
    for north, east in ((0, 0), (5, 0), (5, 5), (0.2, 5), (0.3, 0.3), (-4, 0)):
        trail.add(Point(north, east))
    assert trail.points == [Point(0, 0), Point(-4, 0)]
    for step in range(3 * TRAIL_MAX):
        trail.add(Point(-4.0 - 2.0 * step, 0.0))
    assert len(trail.points) <= TRAIL_MAX + 1
    assert trail.points[0] == Point(0, 0)
