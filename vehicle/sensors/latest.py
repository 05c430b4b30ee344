"""The newest value of a sensor, with a maximum age; after that a failed sensor gives None, and never raises."""

from __future__ import annotations

from typing import Generic, Protocol, TypeVar

from vehicle.hardware.error_text import format_error

T = TypeVar("T")
T_co = TypeVar("T_co", covariant=True)


class SensorSource(Protocol[T_co]):
    """One sensor that provides its newest value."""

    @property
    def fault(self) -> str | None:
        """Why there is no new value, one line; None without a fault."""

    def latest(self, now: float) -> T_co | None:
        """Return the newest value; None if there is none or it is too old. Never blocks and never raises."""

    def close(self) -> None:
        """Release the hardware. May be called twice."""


class LatestValue(Generic[T]):
    """A value with its time."""

    def __init__(self, max_age: float) -> None:
        """`max_age` is how long a value is valid, in s."""
        self.fault: str | None = None
        """Why there is no new value, one line."""
        self._max_age = max_age
        self._newest: tuple[T, float] | None = None  # one tuple, so that another thread reads a consistent pair

    def update(self, value: T, now: float) -> None:
        """Store a new value and clear the fault."""
        self._newest = value, now
        self.fault = None

    def set_fault(self, error: Exception) -> None:
        """Record why there is no new value."""
        self.fault = format_error(error)

    def get(self, now: float) -> T | None:
        """Return the value; None if it is too old."""
        newest = self._newest
        return newest[0] if newest is not None and now - newest[1] <= self._max_age else None
