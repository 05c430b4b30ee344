"""The simulated rover: moves according to its motor outputs and produces the readings of a real rover.

Readings contain sensor values only; the true position is in `motion`, for tests. The simulation is deterministic: the
same outputs at the same times give the same readings; noise (noise.py) is optional and comes from a seed.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import NamedTuple

from vehicle.navigation.geo import Origin, Point
from vehicle.readings import ComputerReadings, Readings
from vehicle.sim.battery import NOMINAL_VOLTAGE, Battery
from vehicle.sim.chassis import Chassis, ChassisMotion, SkidChassis
from vehicle.sim.noise import NoisySensors, SensorNoise, SimulatedFix
from vehicle.sim.walls import Surroundings

LONGEST_STEP = 0.02
"""s, one control cycle. Longer gaps are split into such steps, so that the lag of motors and servo is simulated; not
while the rover stands."""

LONGEST_GAP = 5.0
"""s; the simulation skips the rest of a longer pause of the process."""

ELECTRONICS = 0.5
"""A, for a Raspberry Pi with camera and radio behind a converter."""
RUNNING = 1.2
"""A per motor at full throttle on level ground."""
STALL = 6.0
"""A per motor at full throttle before it turns; in between, in proportion to the lag of the wheel."""

LEAN = 0.02
"""rad per m/s2: tyres and chassis are elastic, so the nose rises on acceleration and the body rolls out of a turn."""
LEAN_LAG = 0.1
"""s: time constant of pitch and roll."""

COMPUTER = ComputerReadings(
    temperature=48.0,
    load=0.1,
    memory_used=400 * 2**20,
    memory_total=2 * 2**30,
    uptime=60.0,
    under_voltage=False,
    throttled=False,
)
"""A healthy Raspberry Pi."""


class SimulatedHome(NamedTuple):
    """Start position of the simulated rover."""

    latitude: float = -35.363262
    """Degrees. The default is the start of ArduPilot's simulators, a flying field in Canberra."""
    longitude: float = 149.165237
    altitude: float = 584.0
    """m above mean sea level."""


class Slope(NamedTuple):
    """A plane that is not level."""

    push: float
    """m/s that it adds to wheels that turn straight downhill, and takes from them uphill."""
    downhill: float = 0.0
    """rad clockwise from north: the way down."""


class SimulatedBody:
    """Fits `vehicle.sensors.Sensors`. `outputs` returns the present motor outputs (SimulatedMotors.outputs)."""

    def __init__(
        self,
        outputs: Callable[[], Sequence[float]],
        *,
        chassis: Chassis | None = None,
        battery: Battery | None = None,
        home: SimulatedHome | None = None,
        seed: int | None = None,
        noise: SensorNoise | None = None,
        slope: Slope | None = None,
        surroundings: Surroundings | None = None,
    ) -> None:
        """Without a `seed` the sensors are perfect; with one they have `noise`."""
        self._slope = slope
        self._surroundings = surroundings
        self._outputs = outputs
        self._chassis = chassis or SkidChassis()
        self._battery = battery or Battery()
        self._home = home or SimulatedHome()
        self._instruments = None if seed is None else NoisySensors(seed, noise)
        self._time: float | None = None
        self._roll = self._pitch = 0.0
        self._origin = Origin(self._home.latitude, self._home.longitude)
        self._fix: tuple[SimulatedFix, tuple[float, float]] | None = None
        """The newest fix with its latitude and longitude, which are the same for several cycles."""

    @property
    def motion(self) -> ChassisMotion:
        """True position and motion."""
        return self._chassis.motion

    def read(self, now: float) -> Readings:
        """Advance the simulation to `now` and return the readings."""
        gap = 0.0 if self._time is None else min(now - self._time, LONGEST_GAP)
        self._time = now
        throttles = self._outputs()
        at_rest = not any(throttles) and not any(self._chassis.motion.wheel_speeds)
        while gap > 1e-9:
            whole = at_rest or gap < 1.5 * LONGEST_STEP  # a slightly late cycle is still one step
            dt = gap if whole else LONGEST_STEP
            self._step(throttles, dt)
            gap -= dt
        return self._measure(now)

    @property
    def clearance(self) -> float | None:
        """True distance to the nearest wall, m; 0 in contact, None without walls."""
        return None if self._surroundings is None else self._surroundings.clearance(self.motion)

    def _step(self, throttles: Sequence[float], dt: float) -> None:
        battery, motion = self._battery, self._chassis.motion
        strength = battery.voltage / NOMINAL_VOLTAGE if battery.remaining > 0.0 else 0.0
        if self._slope is not None:
            motion.push = self._slope.push * math.cos(motion.yaw - self._slope.downhill)
        self._chassis.step(throttles, strength, dt)
        battery.step(ELECTRONICS + self._motor_current(throttles, strength), dt)
        keep = math.exp(-dt / LEAN_LAG)
        self._pitch = _lean(motion.acceleration, self._pitch, keep)
        self._roll = _lean(-motion.sway, self._roll, keep)
        if self._instruments is not None:
            self._instruments.step(dt)

    def _motor_current(self, throttles: Sequence[float], strength: float) -> float:
        """Return the current of all motors in A: it grows with the lag of the wheels, and is scaled by the duty."""
        if strength == 0.0:
            return 0.0
        top = self._chassis.top_speed * strength
        pairs = zip(throttles, self._chassis.motion.wheel_speeds, strict=False)  # a steering servo has no wheel
        return sum(abs(wanted) * (RUNNING * abs(wanted) + STALL * abs(wanted - wheel / top)) for wanted, wheel in pairs)

    def _measure(self, now: float) -> Readings:
        motion, battery, instruments = self._chassis.motion, self._battery, self._instruments
        true = SimulatedFix(motion.north, motion.east, *motion.velocity)
        fix = true if instruments is None else instruments.gps(true)
        wheels = motion.wheel_speeds if instruments is None else instruments.wheels(motion.wheel_speeds)
        if self._fix is None or self._fix[0] is not fix:
            self._fix = fix, self._origin.to_global(Point(fix.north, fix.east))
        latitude, longitude = self._fix[1]
        return Readings(
            roll=self._roll if instruments is None else instruments.angle(self._roll),
            pitch=self._pitch if instruments is None else instruments.angle(self._pitch),
            yaw=motion.yaw if instruments is None else instruments.compass(motion.yaw),
            yaw_rate=motion.yaw_rate if instruments is None else instruments.gyro(motion.yaw_rate),
            velocity_north=fix.velocity_north,
            velocity_east=fix.velocity_east,
            speed=sum(wheels) / len(wheels),
            latitude=latitude,
            longitude=longitude,
            altitude=self._home.altitude,
            gps_fix=3,
            gps_satellites=12,
            gps_hdop=0.8,
            battery_voltage=battery.voltage,
            battery_current=battery.current,
            battery_remaining=battery.remaining,
            wheel_speeds=wheels,
            ranges=() if self._surroundings is None else (self._surroundings.read(motion, now),),
            computer=COMPUTER,
        )


def _lean(acceleration: float, angle: float, keep: float) -> float:
    final = acceleration * LEAN
    return final + (angle - final) * keep
