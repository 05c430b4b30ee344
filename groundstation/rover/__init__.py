"""Drive a vehicle from a Python program: Rover, AsyncRover, State, plans and the errors; docs/python.md.

A Rover is the client of a process `mavhelm api`, which does what the verbs of the command line do.

To add or change:
- a call: a method of `AsyncRover` in `groundstation/rover/async_rover.py` and of `Rover` beside it.
- a kind of plan: a class in `groundstation/rover/mission.py`, and its row in `_LATE` here.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

from groundstation.rover.errors import (
    Differs,
    Disconnected,
    InvalidCall,
    LinkLost,
    NoAnswer,
    NotInControl,
    NoVehicle,
    Refused,
    RoverError,
)

if TYPE_CHECKING:
    from groundstation.rover.async_rover import AsyncRover
    from groundstation.rover.mission import Fence, Mission, Rally
    from groundstation.rover.rover import Rover
    from groundstation.rover.telemetry import Position, State

__all__ = [
    "AsyncRover",
    "Differs",
    "Disconnected",
    "Fence",
    "InvalidCall",
    "LinkLost",
    "Mission",
    "NoAnswer",
    "NoVehicle",
    "NotInControl",
    "Position",
    "Rally",
    "Refused",
    "Rover",
    "RoverError",
    "State",
]
_LATE = {
    "AsyncRover": "async_rover", "Fence": "mission", "Mission": "mission", "Rally": "mission", "Rover": "rover",
    "Position": "telemetry", "State": "telemetry",
}  # fmt: skip
"""Names -> module. Some load asyncio, the dialect or msgspec, which a Rover imports while its process starts; and that
process imports its protocol from here, and no Rover."""


def __getattr__(name: str) -> Any:
    """Import one of them when a program asks for it."""
    if name not in _LATE:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"groundstation.rover.{_LATE[name]}"), name)
