"""What drives each motor output: names for the screen, by the vehicle's own description or by SERVOn_FUNCTION.

ArduPilot's functions: https://ardupilot.org/rover/docs/parameters.html#servo1-function-servo-output-function
"""

from __future__ import annotations

from collections.abc import Mapping

from dialects import messages as m
from dialects.enums import DriveType

PARAMS = {channel: f"SERVO{channel}_FUNCTION" for channel in range(1, 9)}
"""Output -> its parameter. ArduRover drives with the first four by default."""

FUNCTIONS: Mapping[float, str] = {26: "steering servo", 70: "throttle servo", 73: "left wheel", 74: "right wheel"}
"""SERVOn_FUNCTION -> name: GroundSteering, Throttle, ThrottleLeft, ThrottleRight."""

DEFAULT_CHANNELS = (1, 3)
"""Outputs that ArduRover drives with, until their functions are known; then only their numbers are shown."""

DRIVE_NAMES: dict[int, tuple[str, ...]] = {
    DriveType.SKID: ("left wheel", "right wheel"),
    DriveType.ACKERMANN: ("throttle", "steering servo"),
}
"""Outputs of ROVER_DRIVE_STATUS by ROVER_DRIVE_TYPE, if there are as many."""


def drive_names(info: m.RoverDriveInfo | None, count: int) -> tuple[str, ...]:
    """Return the names of the outputs of a vehicle of our dialect; numbers where they are not known."""
    names = DRIVE_NAMES.get(info.drive_type, ()) if info is not None else ()
    return names if len(names) == count else tuple(f"motor {number + 1}" for number in range(count))


def servo_functions(values: Mapping[str, float]) -> Mapping[int, float]:
    """Return output -> its SERVOn_FUNCTION, as far as it is known."""
    return {channel: values[name] for channel, name in PARAMS.items() if name in values}


def servo_names(values: Mapping[str, float]) -> Mapping[int, str]:
    """Return the outputs to show, by number, and what each drives; none if it drives with no output known here."""
    names = {channel: FUNCTIONS.get(values[name]) for channel, name in PARAMS.items() if name in values}
    found = {channel: name for channel, name in names.items() if name is not None}
    return found or {channel: f"servo {channel}" for channel in DEFAULT_CHANNELS if channel not in names}
