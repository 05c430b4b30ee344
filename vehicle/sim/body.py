"""The sensors of the simulated rover: it moves with what the motors get, and says what a real rover would measure.

Deterministic: the same outputs at the same times give the same readings; noise, where wanted, comes from a seed.
"""

from __future__ import annotations

import math
import random
from collections.abc import Callable, Sequence
from typing import NamedTuple

from vehicle.readings import Computer, Readings
from vehicle.sim.battery import NOMINAL_VOLTAGE, Battery
from vehicle.sim.chassis import Chassis, Motion, SkidChassis

EARTH_RADIUS = 6378137.0
"""m, WGS 84 at the equator; flat around home, good to centimetres over the kilometre that this rover drives."""

LONGEST_STEP = 0.02
"""s; one control cycle. Longer gaps are cut into such steps, so that the lag of motors and servo stays true."""

LONGEST_GAP = 5.0
"""s; a process that was stopped for longer loses the rest: the world of the simulator stops with it."""

ELECTRONICS = 0.5
"""A, a Raspberry Pi with camera and radio behind a converter."""
RUNNING = 1.2
"""A for each motor at full throttle on level ground."""
STALL = 6.0
"""A for each motor at full throttle before it turns; in between, by how far the wheel lags behind."""

LEAN = 0.02
"""rad for each m/s2: tyres and chassis give, so the nose lifts when pulling away and the body leans out of a turn."""
LEAN_LAG = 0.1
"""s; the same tyres swing no faster."""

GPS_WANDER = 0.8
"""m, standard deviation of a small receiver in the open ..."""
GPS_MEMORY = 30.0
"""s ... which wanders and does not jump: errors this far apart no longer know of each other."""
ANGLE_NOISE = 0.003
"""rad, standard deviation of a cheap IMU at rest."""

COMPUTER = Computer(
    temperature=48.0,
    load=0.1,
    memory_used=400 * 2**20,
    memory_total=2 * 2**30,
    uptime=60.0,
    under_voltage=False,
    throttled=False,
)
"""A Raspberry Pi without a worry."""


class Home(NamedTuple):
    """Where the simulated rover starts."""

    latitude: float = -35.363262
    """degrees. The default is the flying field in Canberra where ArduPilot's simulators start, so maps agree."""
    longitude: float = 149.165237
    altitude: float = 584.0
    """m above sea level."""


class SimulatedBody:
    """Fits `vehicle.sensors.Sensors`. `outputs` gives what the motors get now (SimulatedMotors.outputs)."""

    def __init__(
        self,
        outputs: Callable[[], Sequence[float]],
        *,
        chassis: Chassis | None = None,
        battery: Battery | None = None,
        home: Home | None = None,
        seed: int | None = None,
    ) -> None:
        self._outputs = outputs
        self._chassis = chassis or SkidChassis()
        self._battery = battery or Battery()
        self._home = home or Home()
        self._noise = None if seed is None else random.Random(seed)
        self._time: float | None = None
        self._roll = self._pitch = 0.0
        self._gps_error = (0.0, 0.0)

    def read(self, now: float) -> Readings:
        """Let the world move on to `now`, then measure it."""
        gap = 0.0 if self._time is None else min(now - self._time, LONGEST_GAP)
        self._time = now
        throttles = self._outputs()
        while gap > 1e-9:
            dt = min(gap, LONGEST_STEP)
            self._step(throttles, dt)
            gap -= dt
        return self._measure()

    def _step(self, throttles: Sequence[float], dt: float) -> None:
        battery, motion = self._battery, self._chassis.motion
        strength = battery.voltage / NOMINAL_VOLTAGE if battery.remaining > 0.0 else 0.0
        self._chassis.step(throttles, strength, dt)
        battery.step(ELECTRONICS + self._motor_current(throttles, strength), dt)
        keep = math.exp(-dt / LEAN_LAG)
        self._pitch = _lean(motion.acceleration, self._pitch, keep)
        self._roll = _lean(-motion.speed * motion.yaw_rate, self._roll, keep)
        if self._noise is not None:
            self._gps_error = self._wander(self._noise, dt)

    def _motor_current(self, throttles: Sequence[float], strength: float) -> float:
        """A from the battery. A motor takes more the further its wheel is behind, and by its duty of the time."""
        if strength == 0.0:
            return 0.0
        top = self._chassis.top_speed * strength
        pairs = zip(throttles, self._chassis.motion.wheel_speeds, strict=False)  # a steering servo has no wheel
        return sum(abs(wanted) * (RUNNING * abs(wanted) + STALL * abs(wanted - wheel / top)) for wanted, wheel in pairs)

    def _wander(self, noise: random.Random, dt: float) -> tuple[float, float]:
        keep = math.exp(-dt / GPS_MEMORY)
        spread = GPS_WANDER * math.sqrt(1 - keep * keep)
        north, east = self._gps_error
        return (north * keep + noise.gauss(0.0, spread), east * keep + noise.gauss(0.0, spread))

    def _measure(self) -> Readings:
        motion, battery = self._chassis.motion, self._battery
        latitude, longitude = self._place(motion)
        return Readings(
            roll=self._roll + self._jitter(),
            pitch=self._pitch + self._jitter(),
            yaw=motion.yaw,
            yaw_rate=motion.yaw_rate,
            north=motion.north,
            east=motion.east,
            velocity_north=motion.speed * math.cos(motion.yaw),
            velocity_east=motion.speed * math.sin(motion.yaw),
            speed=motion.speed,
            latitude=latitude,
            longitude=longitude,
            altitude=self._home.altitude,
            gps_fix=3,
            gps_satellites=12,
            gps_hdop=0.8,
            battery_voltage=battery.voltage,
            battery_current=battery.current,
            battery_remaining=battery.remaining,
            wheel_speeds=motion.wheel_speeds,
            computer=COMPUTER,
        )

    def _jitter(self) -> float:
        return 0.0 if self._noise is None else self._noise.gauss(0.0, ANGLE_NOISE)

    def _place(self, motion: Motion) -> tuple[float, float]:
        """Latitude and longitude in degrees, with the receiver's error."""
        home = self._home
        north, east = motion.north + self._gps_error[0], motion.east + self._gps_error[1]
        width = EARTH_RADIUS * math.cos(math.radians(home.latitude))
        return (home.latitude + math.degrees(north / EARTH_RADIUS), home.longitude + math.degrees(east / width))


def _lean(acceleration: float, angle: float, keep: float) -> float:
    settled = acceleration * LEAN
    return settled + (angle - settled) * keep
