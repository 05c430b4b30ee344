"""All range sensors together: how fast the rover may drive, by what they see and by which of them have failed."""

from __future__ import annotations

import math
from collections.abc import Hashable, Sequence
from typing import NamedTuple

from dialects.enums import DriveLimit, DriveType
from vehicle.drive.stopping import Stopping
from vehicle.params import Params
from vehicle.proximity.cones import angle_between
from vehicle.proximity.mounting import mount_reading
from vehicle.proximity.outline import Motion, Outline, WheelMotion, turn_rate_of
from vehicle.proximity.source import RangeSource
from vehicle.readings import RangeReading, Scan

SOURCES_MAX = 16
"""Sensors that have a place. Further ones are refused and named."""
MIN_INTERVAL = 0.02
"""s between two scans of one sensor that are used: a control cycle."""
FORGOTTEN = 10.0
"""s of silence after which a disarmed rover forgets a sensor: the companion was switched off on purpose."""
AVOID_OBSTACLES = 2
"""Bit of AVOID_ENABLE (ArduPilot: UseProximitySensor)."""
PRX_MAVLINK = 2
"""PRX1_TYPE: messages of companions."""
OVERRIDE_SPEED = 0.2
"""m/s toward an obstacle that an operator overrides: slow enough to see the contact, and to end it."""
SECTORS = 72
"""Sectors of OBSTACLE_DISTANCE, 5 degrees each."""

OBSTACLE, RANGE_SENSOR = DriveLimit.OBSTACLE.value, DriveLimit.RANGE_SENSOR.value


class Barrier(NamedTuple):
    """How fast the rover may close one gap. The first three are those of Gap: m/s for 1 m/s ahead, right, 1 rad/s."""

    x: float
    y: float
    lever: float
    allowed: float
    """m/s"""
    reason: int
    """Bit of DriveLimit."""

    def closing(self, motion: Motion) -> float:
        """Return the m/s at which a motion makes the gap smaller, negative if it grows."""
        return self.x * motion.ahead + self.y * motion.right + self.lever * motion.turn


class Obstacles:
    """Call `move` in each cycle, `hear` for each scan, and `share` whenever outputs are computed."""

    def __init__(self, params: Params, kind: DriveType) -> None:
        self.sources: dict[Hashable, RangeSource] = {}
        self.refused = 0
        """Scans of sensors that have no place."""
        self.overridden = False
        """The operator overrides the limits, down to OVERRIDE_SPEED."""
        self.faults: dict[str, str] = {}
        """Name of a sensor -> why it cannot be believed."""
        self._params, self._kind = params, kind
        self._generation = -1
        self._barriers: list[Barrier] = []
        self._motion = Motion(0.0, 0.0, 0.0)
        self._load_params()

    @property
    def accepts_messages(self) -> bool:
        """Messages of companions count (PRX1_TYPE)."""
        return self._params["PRX1_TYPE"] == PRX_MAVLINK

    @property
    def active(self) -> bool:
        """There is something to avoid, or a sensor that should see it."""
        return self._enabled and bool(self.sources or self.accepts_messages)

    def hear(self, key: Hashable, name: str, scan: Scan | str, now: float) -> None:
        """Take the scan of a sensor, or why its message cannot be used."""
        if self._generation != self._params.generation:
            self._load_params()
        source = self.sources.get(key)
        if source is None:
            if len(self.sources) >= SOURCES_MAX:
                self.refused += 1
                return
            source = self.sources[key] = RangeSource(name, self._outline, -math.inf)
        if now - source.heard < MIN_INTERVAL:
            return
        if isinstance(scan, str):
            source.reject(scan, now)
        else:
            source.update(scan, self._reach, now)

    def sense(self, ranges: Sequence[RangeReading]) -> None:
        """Take the scans of the sensors of this computer. One that has never measured counts as lost."""
        for reading in ranges:
            name, at, source = reading.sensor, reading.at, self.sources.get(reading.sensor)
            if source is None or (at is not None and at > source.heard):
                scan = mount_reading(reading, self._params)
                if at is not None:
                    self.hear(name, name, scan, at)
                else:
                    self.sources[name] = source = RangeSource(name, self._outline, -math.inf)
                    source.scan = scan

    def move(self, wheels: Sequence[float], speed: float | None, turn: float | None, now: float, dt: float, *,
             armed: bool) -> None:  # fmt: skip
        """Carry what was seen along for `dt` s; find faults.

        `speed`, `turn`: what sensors measure; without them the wheels turn as they shall.
        """
        if self._generation != self._params.generation:
            self._load_params()
        wanted = self._wheels.of(wheels)
        self._motion = Motion(
            wanted.ahead if speed is None else speed, wanted.right, wanted.turn if turn is None else turn
        )
        for source in self.sources.values():
            source.move(self._motion, dt, now)
        if not armed:
            self.sources = {
                key: each
                for key, each in self.sources.items()
                if now - each.heard < FORGOTTEN or isinstance(key, str)  # of this computer: those are configured
            }
        self._compare(now)
        self.faults = {each.name: fault for each in self.sources.values() if (fault := each.find_fault(now))}
        if self.accepts_messages and not self.sources:
            self.faults["PRX1"] = "no data"
        self._barriers = self._find_barriers(wanted) if self.active else []

    def share(self, targets: Sequence[float], wheels: Sequence[float]) -> tuple[float, int]:
        """Return the share of the wanted wheel values that is allowed, and the bit of DriveLimit that says why.

        `wheels` are the values now. What leads away from an obstacle is free. Toward it the rover brakes at once if it
        closes faster than it may.
        """
        (ahead, right, turn), commanded = self._wheels.of(targets), self._wheels.of(wheels)
        measured, share, reason = self._motion, 1.0, 0
        for barrier in self._barriers:
            x, y, lever, allowed, why = barrier
            closing = x * ahead + y * right + lever * turn
            if closing <= 0.0:
                continue
            limit = allowed + SLACK
            if barrier.closing(commanded) > limit or barrier.closing(measured) > limit:
                return 0.0, why
            if allowed < share * closing:
                share, reason = allowed / closing, why
        return share, reason

    def nearest(self) -> list[float | None]:
        """Return the m from the outline to the nearest obstacle in each of SECTORS, clockwise from the nose."""
        found: list[float | None] = [None] * SECTORS
        for cone in (cone for source in self.sources.values() for cone in source.scan):
            if cone.distance is None or cone.is_clear:
                continue
            clearance = max(0.0, cone.distance - (self._outline.radius_at(cone.bearing) if cone.central else 0.0))
            first, last = (
                round((cone.bearing + side * cone.half_width * 0.99) / math.tau * SECTORS) for side in (-1, 1)
            )
            for sector in range(first, last + 1):
                before = found[sector % SECTORS]
                found[sector % SECTORS] = clearance if before is None else min(before, clearance)
        return found

    def _near(self, commanded: Motion) -> float:
        """Return the m from the centre beyond which no obstacle matters in the next cycles, however the motors rise."""
        radius = self._outline.radius
        corner = max(math.hypot(each.ahead, each.right) + radius * abs(each.turn) for each in (commanded, self._motion))
        fastest = min(self._fastest, corner + SPEED_STEP * self._fastest)
        return radius + self._margin + self._stopping.distance(fastest)

    def _find_barriers(self, commanded: Motion) -> list[Barrier]:
        lost, least = self._params["AVOID_LOST_SPD"], OVERRIDE_SPEED if self.overridden else 0.0
        found, near = [], self._near(commanded) ** 2
        for source in self.sources.values():
            for places, reason in ((source.places(), OBSTACLE), (source.ends(), RANGE_SENSOR)):
                for place in places:
                    if place[0] * place[0] + place[1] * place[1] < near:
                        clearance, x, y, lever = self._outline.gap(place)
                        allowed = self._stopping.speed_within(clearance - self._margin)
                        found.append(Barrier(x, y, lever, max(allowed, least), reason))
            if source.name in self.faults:
                found += self._blocked(source, max(lost, least))
        if self.accepts_messages and not self.sources:
            found += self._blocked(RangeSource("", self._outline, 0.0), max(lost, least))
        return found

    def _blocked(self, source: RangeSource, allowed: float) -> list[Barrier]:
        gaps = map(self._outline.gap, source.unseen())
        return [Barrier(gap.x, gap.y, gap.lever, allowed, RANGE_SENSOR) for gap in gaps]

    def _compare(self, now: float) -> None:
        """Find sensors of one direction that differ from others."""
        for source in self.sources.values():
            if len(source.scan) != 1:
                continue
            others = [each for each in self.sources.values() if each is not source]
            if not any(_differ(source.scan, other.scan) for other in others):
                source.contradicted_since = None
            elif source.contradicted_since is None:
                source.contradicted_since = now

    def _load_params(self) -> None:
        params, self._generation = self._params, self._params.generation
        self._enabled = bool(int(params["AVOID_ENABLE"]) & AVOID_OBSTACLES)
        self._outline = Outline(params)
        self._wheels = WheelMotion(params, self._kind)
        self._stopping = Stopping.of(params, params["AVOID_ACCEL_MAX"])
        self._margin: float = params["AVOID_MARGIN"]
        self._fastest = CORNER_SPEED * max(params["SPEED_MAX"], self._outline.radius * turn_rate_of(params))
        self._reach = self._margin + self._stopping.distance(self._fastest) + self._outline.radius


CORNER_SPEED = 1.5
"""Corners of a rover that turns and drives are faster than its centre."""
SPEED_STEP = 0.2
"""Share of the top speed by which a motor rises in the next cycles: the barriers are found anew in each of them."""
SLACK = 0.02
"""m/s: noise of a wheel encoder, which shall not brake a rover that stands before a wall."""


def _differ(single: Scan, others: Scan) -> bool:
    """Return whether a sensor of one direction and another one see different distances in the same direction."""
    cone = single[0]
    inside = [
        each
        for each in others
        if each.distance is not None and angle_between(each.bearing, cone.bearing) <= cone.half_width
    ]
    if cone.distance is None or not inside:
        return False
    far = min([cone.far, *(each.far for each in inside)])
    one, other = min(cone.distance, far), min(min(each.distance or 0.0 for each in inside), far)
    return abs(one - other) > 0.3 + 0.3 * min(one, other)
