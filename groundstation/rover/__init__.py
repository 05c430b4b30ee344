"""Drive a vehicle from a Python program: Rover, AsyncRover, State and the errors; docs/python.md.

A Rover is the client of a process `mavhelm api`, which does what the verbs of the command line do.

To add or change:
- a call: a method of `AsyncRover` in `groundstation/rover/async_rover.py` and of `Rover` beside it.
"""

from groundstation.rover.async_rover import AsyncRover
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
from groundstation.rover.rover import Rover
from groundstation.rover.telemetry import Position, State

__all__ = [
    "AsyncRover",
    "Differs",
    "Disconnected",
    "InvalidCall",
    "LinkLost",
    "NoAnswer",
    "NoVehicle",
    "NotInControl",
    "Position",
    "Refused",
    "Rover",
    "RoverError",
    "State",
]
