"""Position and motion estimate: a complementary filter over gyro, compass, wheels and GPS.

Fast sensors carry the estimate from cycle to cycle, slow sensors correct it:

    gyro - bias --integrate--> yaw <--HEADING_TIME-- compass + offset; the correction also teaches the gyro bias
    GPS course while moving --OFFSET_TIME--> offset of the compass (mounting, declination, iron in the chassis)
    GPS speed while moving --SCALE_TIME--> scale of the wheels (tyres, and inaccurate parameters)
    wheels * scale along yaw --integrate--> position <--POSITION_TIME-- GPS; a single outlier is ignored

Each correction begins as a plain mean (gain 1/n) and settles at its time constant, so that the first seconds are used.
GPS receivers of this class wander by decimetres over half a minute: POSITION_TIME hides the wander as far as the drift
of wheels and heading allows. Without wheels the GPS gives the speed; without a compass its course gives the heading.
The course of a drive that can move sideways differs from its heading: the wheels measure by how much, or else the GPS.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

from vehicle.navigation.dead_reckoning import AveragingGain, DeadReckoning
from vehicle.navigation.estimate import Estimate
from vehicle.navigation.geo import Origin, Point, wrap_angle
from vehicle.navigation.wheel_odometry import WheelOdometry
from vehicle.readings import Readings

HEADING_TIME = 3.0
"""s; the noise of a magnetometer is averaged by then, and a gyro bias of 1 deg/s has made 3 degrees."""
BIAS_TIME = 20.0
"""s until the gyro bias is learned."""
BIAS_MAX = 0.1
"""rad/s; a larger value is not a bias but a broken gyro."""
OFFSET_TIME = 60.0
"""s of straight driving until the compass offset is learned; a course is accurate to 4 degrees at 0.8 m/s."""
POSITION_TIME = 100.0
"""s; a longer time hides more of the wander and shows more of the errors of wheels and heading."""
COURSE_SPEED = 0.4
"""m/s above which the GPS course is usable: the velocity is accurate to 0.05 m/s."""
COURSE_RATE = 0.3
"""rad/s up to which course and heading are considered equal."""
WHEELLESS_TIME = 20.0
"""s; POSITION_TIME without wheels: a speed that comes from fixes drifts sooner."""
FIX_PERIOD = 0.2
"""s between two fixes of common receivers."""
GPS_LOST = 3.0
"""s without a fix until the position is lost (docs/safety.md)."""
GPS_SAME = 1.0
"""s after which an unchanged fix counts as a new one: a receiver at rest may repeat its position."""
FIX_3D = 3
OUTLIER_DISTANCE = 5.0
"""m; a fix this far off, and more than three times the accuracy, is ignored ..."""
OUTLIERS_MAX = 10
"""... but this many in a row are right, and the estimate is wrong."""
ACCURACY_MAX = 5.0
"""m; with a larger error the position is not good."""
DRIFT = 0.03
"""m of error for each metre measured by the wheels."""
BLIND_DRIFT = 0.1
"""m/s of error without wheels and GPS."""
DT_MAX = 0.5
"""s; a longer gap is not integrated."""


class Estimator:
    """The filter; call `update` in each cycle."""

    def __init__(self, aside: Sequence[int] = ()) -> None:
        """Create the filter.

        `aside`: factor of each wheel for motion to the right, if the drive can (vehicle/drive/mixer.py, FOUR_WHEELS).
        """
        self.estimate = Estimate()
        self._wheels = WheelOdometry(aside)
        self._at: float | None = None
        self._yaw: float | None = None
        self._bias = self._offset = 0.0
        self._offset_gain = AveragingGain(OFFSET_TIME)
        self._speed: float | None = None
        self._sideways = 0.0
        self._reckoning = DeadReckoning()
        self._place_gain = AveragingGain(POSITION_TIME)
        self._origin: Origin | None = None
        self._fix: tuple[float | None, ...] = ()
        self._fix_at = -math.inf
        self._outliers = self._resets = 0
        self._drift = 0.0

    def update(self, readings: Readings, now: float) -> Estimate:
        """Update the estimate with the readings of this cycle; impossible values count as missing."""
        dt = 0.0 if self._at is None else max(0.0, min(DT_MAX, now - self._at))
        self._at = now
        rate = valid_yaw_rate(readings)
        self._turn(rate, _valid(readings.yaw, 1e6), dt)
        wheels, sideways = self._wheels.speed(readings), self._wheels.sideways_speed(readings)
        if wheels is not None:
            self._speed = wheels
        if sideways is not None:
            self._sideways = sideways
        self._move(dt, wheels is not None)
        fix = self._new_fix(readings, now)
        if fix is not None:
            self._apply_fix(fix, readings, now, rate, wheels is not None)
        self.estimate = self._build_estimate(rate, wheels, now)
        return self.estimate

    def set_origin(self, origin: Origin) -> None:
        """Make `origin` 0/0; the rover keeps its global position. No effect before the first fix."""
        if self._origin is not None:
            self._reckoning.set_position(origin.to_local(*self._origin.to_global(self._reckoning.place)))
            self._origin = origin
            self._resets += 1
            self.estimate = self.estimate._replace(place=self._reckoning.place, origin=origin, resets=self._resets)

    def set_gyro_bias(self, bias: float) -> bool:
        """Set the gyro bias, rad/s; return False if the value cannot be a bias."""
        fits = abs(bias) <= BIAS_MAX
        if fits:
            self._bias = bias
        return fits

    def _turn(self, rate: float | None, compass: float | None, dt: float) -> None:
        if self._yaw is None:
            self._yaw = compass
            return
        if rate is not None:
            self._yaw += (rate - self._bias) * dt
        if compass is not None:
            error = wrap_angle(compass + self._offset - self._yaw)
            self._yaw += error * dt / (HEADING_TIME + dt) if rate is not None else error
            if rate is not None:
                self._learn_bias(-error * dt / (HEADING_TIME * BIAS_TIME))
        self._yaw = wrap_angle(self._yaw)

    def _move(self, dt: float, wheels: bool) -> None:
        if self._yaw is None or self._speed is None:
            return
        way, right = self._speed * dt, self._sideways * dt
        self._reckoning.advance(way, self._yaw)
        if right:
            self._reckoning.advance(right, self._yaw + math.pi / 2)
        self._drift += DRIFT * math.hypot(way, right) if wheels else BLIND_DRIFT * dt

    def _new_fix(self, readings: Readings, now: float) -> tuple[float, float] | None:
        """Return latitude and longitude of a fix that has not been used yet, or None."""
        latitude, longitude = _valid(readings.latitude, 90.0), _valid(readings.longitude, 180.0)
        if latitude is None or longitude is None or (readings.gps_fix or 0) < FIX_3D:
            return None
        fix = (latitude, longitude, readings.velocity_north, readings.velocity_east)
        if fix == self._fix and now - self._fix_at < GPS_SAME:
            return None
        self._fix = fix
        return latitude, longitude

    def _apply_fix(
        self, fix: tuple[float, float], readings: Readings, now: float, rate: float | None, wheels: bool
    ) -> None:
        north, east = _valid(readings.velocity_north, 50.0), _valid(readings.velocity_east, 50.0)
        if north is not None and east is not None:
            self._update_sideways(north, east, readings)
            self._apply_velocity(north, east, rate, readings.yaw is not None, wheels)
        dt = min(GPS_SAME, now - self._fix_at)
        self._fix_at = now
        if self._origin is None:  # the distance driven before the first fix is kept
            self._origin = Origin(*Origin(*fix).to_global(Point(-self._reckoning.north, -self._reckoning.east)))
        error = self._origin.to_local(*fix)
        north_off, east_off = error.north - self._reckoning.north, error.east - self._reckoning.east
        if self._is_outlier(math.hypot(north_off, east_off)):
            return
        self._place_gain.time = POSITION_TIME if wheels else WHEELLESS_TIME
        gain = self._place_gain.next(dt)
        self._reckoning.correct_position(north_off, east_off, gain)
        self._drift *= 1.0 - gain

    def _is_outlier(self, distance: float) -> bool:
        if distance <= max(OUTLIER_DISTANCE, 3.0 * self._drift):
            self._outliers = 0
            return False
        self._outliers += 1
        if self._outliers < OUTLIERS_MAX:
            return True
        self._place_gain = AveragingGain(POSITION_TIME)  # begins with a gain of 1: the fix becomes the position
        self._outliers = 0
        self._resets += 1
        return False

    def _update_sideways(self, north: float, east: float, readings: Readings) -> None:
        """Estimate the sideways speed if the drive can move sideways and its wheels do not measure it."""
        if self._yaw is not None and self._wheels.sideways_speed(readings) is None:
            across = east * math.cos(self._yaw) - north * math.sin(self._yaw)
            self._sideways = (self._sideways + across) / 2

    def _apply_velocity(self, north: float, east: float, rate: float | None, compass: bool, wheels: bool) -> None:
        speed = math.hypot(north, east)
        along = speed if self._yaw is None else north * math.cos(self._yaw) + east * math.sin(self._yaw)
        if not wheels:
            self._speed = along if self._speed is None else (self._speed + along) / 2
        if speed < COURSE_SPEED or abs(rate or 0.0) > COURSE_RATE:
            return
        if wheels and self._yaw is not None:
            self._learn_scale(along)
        course = math.atan2(east, north) - math.atan2(self._sideways, self._speed or 0.0)
        if self._yaw is None:
            self._yaw = wrap_angle(course)
            return
        change = wrap_angle(course - self._yaw) * self._offset_gain.next(FIX_PERIOD)
        if compass:
            self._offset = wrap_angle(self._offset + change)
            self._reckoning.correct_heading(change)
        else:
            self._learn_bias(-change / BIAS_TIME)
        self._yaw = wrap_angle(self._yaw + change)

    def _learn_scale(self, along: float) -> None:
        speed = self._speed or 0.0
        if abs(speed) < COURSE_SPEED:
            return
        self._reckoning.correct_scale(self._wheels.update_scale(along, speed, FIX_PERIOD))

    def _learn_bias(self, change: float) -> None:
        self._bias = max(-BIAS_MAX, min(BIAS_MAX, self._bias + change))

    def _build_estimate(self, rate: float | None, wheels: float | None, now: float) -> Estimate:
        since = now - self._fix_at
        if wheels is None and since > GPS_LOST:
            self._speed, self._sideways = None, 0.0
        accuracy = math.inf if self._origin is None else 1.0 + self._drift
        return Estimate(
            yaw=self._yaw,
            yaw_rate=None if rate is None else rate - self._bias,
            speed=self._speed,
            sideways=self._sideways,
            place=self._reckoning.place,
            moving_place=self._origin is not None or (self._yaw is not None and wheels is not None),
            origin=self._origin,
            accuracy=accuracy,
            resets=self._resets,
            good=self._yaw is not None and since <= GPS_LOST and accuracy <= ACCURACY_MAX,
        )


def valid_yaw_rate(readings: Readings) -> float | None:
    """Return the turn rate of the gyro in rad/s, None if it is missing or impossible."""
    return _valid(readings.yaw_rate, 50.0)


def _valid(value: float | None, largest: float) -> float | None:
    return value if value is not None and -largest <= value <= largest else None  # NaN is not
