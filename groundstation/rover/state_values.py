"""StateValues: the values of the newest state as attributes. State itself is imported once a Rover is open."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from groundstation.rover.telemetry import Position, State


class StateValues(ABC):
    """The values of the newest state that programs ask for most."""

    @property
    @abstractmethod
    def state(self) -> State:
        """The newest state; ten come in a second. Raises Disconnected."""

    @property
    def mode(self) -> str:
        """The mode, such as MANUAL."""
        return self.state.mode

    @property
    def armed(self) -> bool:
        """Whether its motors are armed."""
        return self.state.armed

    @property
    def position(self) -> Position | None:
        """Where it is; None without a fix."""
        return self.state.position

    @property
    def heading(self) -> float | None:
        """Degrees clockwise from north, 0 to 360."""
        return self.state.heading

    @property
    def speed(self) -> float | None:
        """m/s over ground."""
        return self.state.speed

    @property
    def battery(self) -> float | None:
        """What is left of the battery, 0 to 1."""
        return self.state.battery
