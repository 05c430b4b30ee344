"""What cheap sensors make of the truth: noise, biases and a GPS that speaks five times a second. Seeded, no clock."""

from __future__ import annotations

import math
import random
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple


@dataclass(frozen=True, slots=True)
class SensorNoise:
    """Standard deviations. Biases are drawn once a seed, as one sensor differs from the next."""

    angle: float = 0.003
    """rad, roll and pitch of a cheap IMU."""
    gyro: float = 0.005
    """rad/s"""
    gyro_bias: float = 0.01
    compass: float = 0.02
    """rad; a magnetometer far enough from the motors ..."""
    compass_bias: float = 0.03
    """... and not quite straight on its chassis."""
    wheel: float = 0.02
    """m/s"""
    wheel_scale: float = 0.01
    """Tyres are not as round as their data sheet."""
    gps: float = 0.05
    """m from one fix to the next ..."""
    gps_wander: float = 0.2
    """... and m over gps_memory, a receiver with corrections (SBAS) in the open. A plain one wanders 1 m and more, and
    no filter can tell that from driving: then a rover is 1 m beside its line, however well it steers."""
    gps_memory: float = 30.0
    """s; it wanders and does not jump: errors this far apart no longer know of each other."""
    gps_velocity: float = 0.05
    """m/s"""
    gps_period: float = 0.2
    """s"""


class SimulatedFix(NamedTuple):
    """m and m/s, north and east, as the receiver has them."""

    north: float
    east: float
    velocity_north: float
    velocity_east: float


class NoisySensors:
    """The sensors of one rover. `step` lets their errors wander, the rest measures."""

    def __init__(self, seed: int, noise: SensorNoise | None = None) -> None:
        self._noise = noise = noise or SensorNoise()
        self._random = random.Random(seed)
        self._gyro_bias = self._error(noise.gyro_bias)
        self._compass_bias = self._error(noise.compass_bias)
        self._scale = 1.0 + self._error(noise.wheel_scale)
        self._wander = (self._error(noise.gps_wander), self._error(noise.gps_wander))
        self._fix: SimulatedFix | None = None
        self._fix_in = 0.0

    def step(self, dt: float) -> None:
        """Let `dt` s pass."""
        keep = math.exp(-dt / self._noise.gps_memory)
        spread = self._noise.gps_wander * math.sqrt(1 - keep * keep)
        north, east = self._wander
        self._wander = (north * keep + self._error(spread), east * keep + self._error(spread))
        self._fix_in -= dt

    def angle(self, true: float) -> float:
        """Roll or pitch."""
        return true + self._error(self._noise.angle)

    def gyro(self, true: float) -> float:
        """Turn rate."""
        return true + self._gyro_bias + self._error(self._noise.gyro)

    def compass(self, true: float) -> float:
        """Heading, 0..2 pi."""
        return (true + self._compass_bias + self._error(self._noise.compass)) % math.tau

    def wheels(self, true: Sequence[float]) -> tuple[float, ...]:
        """Speed of each wheel; one that stands says so, for an encoder counts nothing then."""
        return tuple(speed and speed * self._scale + self._error(self._noise.wheel) for speed in true)

    def gps(self, true: SimulatedFix) -> SimulatedFix:
        """The newest fix."""
        if self._fix is None or self._fix_in <= 1e-9:
            self._fix_in = self._noise.gps_period
            self._fix = SimulatedFix(
                true.north + self._wander[0] + self._error(self._noise.gps),
                true.east + self._wander[1] + self._error(self._noise.gps),
                true.velocity_north + self._error(self._noise.gps_velocity),
                true.velocity_east + self._error(self._noise.gps_velocity),
            )
        return self._fix

    def _error(self, deviation: float) -> float:
        return self._random.gauss(0.0, deviation)
