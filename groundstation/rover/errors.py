"""RoverError and its kinds: how a call of a program failed. The text has the vehicle's own words."""

from __future__ import annotations


class RoverError(Exception):
    """A call failed."""


class InvalidCall(RoverError, ValueError):
    """An argument cannot be right; nothing was sent."""


class NoVehicle(RoverError):
    """No vehicle was heard."""


class Refused(RoverError):
    """The vehicle, or the ground station for it, refused."""


class NoAnswer(RoverError):
    """The vehicle did not answer, or did not do what it had accepted."""


class LinkLost(NoAnswer):
    """The heartbeats of the vehicle ended."""


class NotInControl(RoverError):
    """Another ground station drives."""


class Differs(RoverError):
    """A comparison failed, or there is no such thing."""


class Disconnected(RoverError):
    """This Rover is not connected, or its connection has ended."""


BY_CODE: dict[int, type[RoverError]] = {
    2: InvalidCall, 3: NoVehicle, 4: Refused, 5: NoAnswer, 6: NotInControl, 7: Differs,
}  # fmt: skip
"""Exit code of a verb (groundstation/verbs/common/exit_codes.py) -> the error. All others are a RoverError."""
