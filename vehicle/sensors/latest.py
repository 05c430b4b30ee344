"""The newest value of a sensor and how long it counts; a sensor that fails gives None after that, and never raises."""

from __future__ import annotations

from typing import Generic, Protocol, TypeVar

from vehicle.hardware.error_text import format_error

T = TypeVar("T")
T_co = TypeVar("T_co", covariant=True)


class SensorSource(Protocol[T_co]):
    """One sensor."""

    @property
    def fault(self) -> str | None:
        """Why there is nothing new, one line; None while all is well."""

    def latest(self, now: float) -> T_co | None:
        """The newest value; None where it is too old or there was none. Never blocks and never raises."""

    def close(self) -> None:
        """Let go of the hardware. May come twice."""


class LatestValue(Generic[T]):
    """A value with its time."""

    def __init__(self, max_age: float) -> None:
        """`max_age` s is how long a value counts."""
        self.fault: str | None = None
        self._max_age = max_age
        self._newest: tuple[T, float] | None = None  # replaced as one, so that another thread never sees half of it

    def update(self, value: T, now: float) -> None:
        """A new value."""
        self._newest = value, now
        self.fault = None

    def set_fault(self, error: Exception) -> None:
        """No new value this time."""
        self.fault = format_error(error)

    def get(self, now: float) -> T | None:
        """The value, while it counts."""
        newest = self._newest
        return newest[0] if newest is not None and now - newest[1] <= self._max_age else None
