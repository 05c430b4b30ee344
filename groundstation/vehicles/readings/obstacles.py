"""Obstacles that a vehicle reports: OBSTACLE_DISTANCE and DISTANCE_SENSOR, as bearings and distances."""

from __future__ import annotations

import math

from dialects import messages as m

FRESH = 2.5
"""s for which a report counts: vehicles send one each second."""
UNKNOWN = 65535
"""Element of OBSTACLE_DISTANCE that was not measured."""
GLOBAL_FRAME, BODY_FRAME = 0, 12
"""MAV_FRAME of OBSTACLE_DISTANCE: its angles count from north, or from the nose."""
SIDES = 8
"""MAV_SENSOR_ORIENTATION below which a DISTANCE_SENSOR looks to a side, in steps of 45 degrees to the right."""

Obstacle = tuple[float, float]
"""Bearing clockwise from the nose, rad, and distance, m."""


class ObstacleReadings:
    """The newest reports of one vehicle."""

    def __init__(self) -> None:
        self._around: tuple[Obstacle, ...] = ()
        self._around_at = -math.inf
        self._sensors: dict[int, tuple[float, Obstacle | None]] = {}
        """Id of a DISTANCE_SENSOR -> when it was heard, and what it sees."""

    def handle_around(self, message: m.ObstacleDistance, heading: float | None, now: float) -> None:
        """Handle a scan; one that counts from north needs a heading, rad."""
        turn = 0.0 if message.frame == BODY_FRAME else None if heading is None else -heading
        if turn is None or message.frame not in (GLOBAL_FRAME, BODY_FRAME):
            return
        step = message.increment_f if math.isfinite(message.increment_f) and message.increment_f else message.increment
        offset = message.angle_offset if math.isfinite(message.angle_offset) else 0.0
        self._around_at = now
        self._around = tuple(
            (round((turn + math.radians(offset + index * step)) % math.tau, 3), distance / 100)
            for index, distance in enumerate(message.distances)
            if distance != UNKNOWN and distance <= message.max_distance
        )

    def handle_sensor(self, message: m.DistanceSensor, now: float) -> None:
        """Handle what one sensor sees; one that looks up or down is none."""
        if message.orientation >= SIDES:
            return
        sees = message.current_distance < message.max_distance
        seen = (message.orientation * math.tau / SIDES, message.current_distance / 100) if sees else None
        self._sensors[message.id] = (now, seen)

    def nearest(self, now: float, *, newest: bool) -> Obstacle | None:
        """Return the nearest obstacle; None if none is reported.

        With `newest` only the newest report counts: our vehicle tells the nearest one of all in each.
        """
        single = ((at, (seen,)) for at, seen in self._sensors.values() if seen is not None)
        reports: list[tuple[float, tuple[Obstacle, ...]]] = [(self._around_at, self._around), *single]
        fresh = [each for each in reports if now - each[0] <= FRESH]
        if newest and fresh:
            fresh = [max(fresh, key=lambda each: each[0])]
        return min((seen for _, found in fresh for seen in found), key=lambda seen: seen[1], default=None)

    def around(self, now: float) -> tuple[Obstacle, ...]:
        """Return all obstacles of the newest scan; without one those of the single sensors."""
        if now - self._around_at <= FRESH:
            return self._around
        return tuple(seen for at, seen in self._sensors.values() if seen is not None and now - at <= FRESH)
