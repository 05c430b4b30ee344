"""One range sensor: its newest scans, carried along with the rover, and whether it can be believed."""

from __future__ import annotations

import math

from vehicle.proximity.outline import Motion, ObstaclePoint, Outline, carry
from vehicle.readings import Cone, Scan

SILENCE = 0.5
"""s without a message from which on a sensor is lost: ArduPilot's for MAVLink proximity."""
SCANS_KEPT = 5
"""Scans that count: an obstacle is gone when so many scans in a row do not see it.

With 3 of them one of 3050 random drives touched a wall that three dropouts in a row had hidden."""
MEMORY = 5.0
"""s that the last scans of a lost sensor count."""
FROZEN_WAY = 0.3
"""m toward or away from what a sensor sees, after which its distance must have changed."""
BLIND_TIME = 0.5
"""s without a measured direction from which on a sensor is blind."""
SPACING, POINTS_MAX = 0.1, 9
"""m between the points of a wide cone, and how many it has at most."""


class RangeSource:
    """One sensor."""

    def __init__(self, name: str, outline: Outline, now: float) -> None:
        self.name = name
        """As texts have it: 196/0."""
        self.scan: Scan = ()
        """The newest scan."""
        self.heard = self.seeing = now
        """When it was heard last, and when it measured something last."""
        self.contradicted_since: float | None = None
        self.problem: str | None = None
        """Why its newest message was not used."""
        self._outline = outline
        self._scans: list[list[ObstaclePoint]] = []
        self._ends: list[ObstaclePoint] = []
        self._way = 0.0, 0.0
        """m ahead and to the right since any distance has changed."""

    def update(self, scan: Scan, reach: float, now: float) -> None:
        """Take a scan; only what is nearer than `reach` m counts."""
        self.heard, self.problem = now, None
        if any(cone.distance is not None for cone in scan):
            self.seeing = now
        if [cone.distance for cone in scan] != [cone.distance for cone in self.scan]:
            self._way = 0.0, 0.0
        self.scan = scan
        self._scans = [*self._scans[1 - SCANS_KEPT :], [place for cone in scan for place in self._places(cone, reach)]]
        self._ends = [
            place
            for cone in scan
            if cone.is_clear and cone.far <= reach
            for place in self._points(cone, self._start(cone) + cone.far)
        ]

    def reject(self, problem: str, now: float) -> None:
        """Note a message that cannot be used."""
        self.heard, self.problem = now, problem

    def move(self, motion: Motion, dt: float, now: float) -> None:
        """Carry the scans along with the rover."""
        if now - self.heard > MEMORY:
            self._scans.clear()
            self._ends.clear()
        if not (motion.ahead or motion.right or motion.turn):
            return
        self._scans = [carry(places, motion, dt) for places in self._scans]
        self._ends = carry(self._ends, motion, dt)
        ahead, right = self._way
        self._way = ahead + motion.ahead * dt, right + motion.right * dt

    def places(self) -> list[ObstaclePoint]:
        """Return where obstacles are."""
        return [place for places in self._scans for place in places]

    def ends(self) -> list[ObstaclePoint]:
        """Return where the sensor sees no farther, and has seen nothing: beyond may be an obstacle."""
        return self._ends

    def find_fault(self, now: float) -> str | None:
        """Return why the sensor cannot be believed, or None."""
        if now - self.heard > SILENCE:
            return "no data"
        if self.problem is not None:
            return self.problem
        if now - self.seeing > BLIND_TIME:
            return "blind"
        if any(self._way_along(cone.bearing) > FROZEN_WAY for cone in self.scan if cone.distance and not cone.is_clear):
            return "frozen"
        if self.contradicted_since is not None and now - self.contradicted_since > CONTRADICTION_TIME:
            return "contradicts another"
        return None

    def unseen(self) -> list[ObstaclePoint]:
        """Return points right before the outline, all over what the sensor should see."""
        return [
            place
            for cone in self.scan or EVERYWHERE
            for place in self._points(cone, self._outline.radius_at(cone.bearing) + 0.01)
        ]

    def _way_along(self, bearing: float) -> float:
        return abs(self._way[0] * math.cos(bearing) + self._way[1] * math.sin(bearing))

    def _places(self, cone: Cone, reach: float) -> list[ObstaclePoint]:
        if cone.distance is None or cone.is_clear or cone.distance > reach:
            return []
        return self._points(cone, self._start(cone) + cone.distance)

    def _start(self, cone: Cone) -> float:
        return 0.0 if cone.central else self._outline.radius_at(cone.bearing)

    @staticmethod
    def _points(cone: Cone, radius: float) -> list[ObstaclePoint]:
        """Return points on the arc of a cone."""
        count = max(1, min(POINTS_MAX, math.ceil(2 * cone.half_width * radius / SPACING)))
        step = 2 * cone.half_width / count
        first = cone.bearing - cone.half_width + step / 2
        return [
            (radius * math.cos(first + index * step), radius * math.sin(first + index * step)) for index in range(count)
        ]


CONTRADICTION_TIME = 2.0
"""s for which two sensors must differ: their messages come at different times."""
EVERYWHERE: Scan = tuple(Cone(index * math.pi / 8, math.pi / 16, None, 0.0) for index in range(16))
"""All directions, for sensors that never said where they look."""
