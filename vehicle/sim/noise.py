"""Errors of cheap sensors: noise, biases and a GPS with five fixes per second. Seeded, no clock."""

from __future__ import annotations

import math
import random
from collections.abc import Sequence
from typing import NamedTuple

import msgspec


class SensorNoise(msgspec.Struct, frozen=True):
    """Standard deviations. Biases are drawn once for a seed, as they differ between sensors."""

    angle: float = 0.003
    """rad, roll and pitch of a cheap IMU."""
    gyro: float = 0.005
    """rad/s"""
    gyro_bias: float = 0.01
    compass: float = 0.02
    """rad; of a magnetometer at some distance from the motors."""
    compass_bias: float = 0.03
    """rad; of a magnetometer that is not aligned exactly."""
    wheel: float = 0.02
    """m/s"""
    wheel_scale: float = 0.01
    """Relative error of the wheel diameter."""
    gps: float = 0.05
    """m, white noise of a fix."""
    gps_wander: float = 0.2
    """m, slow drift of a receiver with corrections (SBAS) under open sky. Without corrections the drift is 1 m and
    more, which no filter can distinguish from motion: the rover is 1 m beside its line, however well it steers."""
    gps_memory: float = 30.0
    """s, correlation time of the drift."""
    gps_velocity: float = 0.05
    """m/s"""
    gps_period: float = 0.2
    """s between two fixes."""


class SimulatedFix(NamedTuple):
    """Position and velocity of a fix, north and east, m and m/s."""

    north: float
    east: float
    velocity_north: float
    velocity_east: float


class NoisySensors:
    """The sensors of one rover. `step` advances their drift; the other methods add errors to true values."""

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
        """Advance the drift by `dt` s."""
        keep = math.exp(-dt / self._noise.gps_memory)
        spread = self._noise.gps_wander * math.sqrt(1 - keep * keep)
        north, east = self._wander
        self._wander = (north * keep + self._error(spread), east * keep + self._error(spread))
        self._fix_in -= dt

    def angle(self, true: float) -> float:
        """Return roll or pitch with noise."""
        return true + self._error(self._noise.angle)

    def gyro(self, true: float) -> float:
        """Return the turn rate with bias and noise."""
        return true + self._gyro_bias + self._error(self._noise.gyro)

    def compass(self, true: float) -> float:
        """Return the heading with bias and noise, 0 to 2 pi."""
        return (true + self._compass_bias + self._error(self._noise.compass)) % math.tau

    def wheels(self, true: Sequence[float]) -> tuple[float, ...]:
        """Return the speed of each wheel with errors; exactly 0 at rest, where an encoder counts nothing."""
        return tuple(speed and speed * self._scale + self._error(self._noise.wheel) for speed in true)

    def gps(self, true: SimulatedFix) -> SimulatedFix:
        """Return the newest fix; a new one every gps_period."""
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
