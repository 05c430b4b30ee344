"""What drives each motor output: names for the screen, by the vehicle's own description or by SERVOn_FUNCTION.

ArduPilot's functions: https://ardupilot.org/rover/docs/parameters.html#servo1-function-servo-output-function
"""

from __future__ import annotations

from collections.abc import Mapping

from dialects import messages as m
from dialects.enums import Autopilot, DriveType
from link.core import Outgoing, Received
from link.services.param.client import ParamClient

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

REPEAT_AFTER, TRIES = 1.0, 3
"""As the settings (ardupilot_checks.py). A function that is not answered stays unknown."""


def drive_names(info: m.RoverDriveInfo | None, count: int) -> tuple[str, ...]:
    """Return the names of the outputs of a vehicle of our dialect; numbers where they are not known."""
    names = DRIVE_NAMES.get(info.drive_type, ()) if info is not None else ()
    return names if len(names) == count else tuple(f"motor {number + 1}" for number in range(count))


class ServoFunctions:
    """Reads SERVOn_FUNCTION of one ArduPilot vehicle, once. `system` and `component` are our ids."""

    def __init__(self, system: int, component: int, *, target: tuple[int, int]) -> None:
        self._own_id = (system, component)
        self._target = target
        self.restart()

    @staticmethod
    def applies_to(autopilot: int) -> bool:
        """Return whether this autopilot has these parameters."""
        return autopilot == Autopilot.ARDUPILOT

    def restart(self) -> None:
        """Read again: the vehicle may have restarted with other functions."""
        self._requested = False
        self._params = ParamClient(
            *self._own_id, target_system=self._target[0], target_component=self._target[1], repeat_after=REPEAT_AFTER,
            tries=TRIES,
        )  # fmt: skip

    @property
    def names(self) -> Mapping[int, str]:
        """Return the outputs to show, by number, and what each drives; none if it drives with no output known here."""
        functions = {channel: self._params.params.get(name) for channel, name in PARAMS.items()}
        names = {channel: FUNCTIONS.get(param.value) for channel, param in functions.items() if param is not None}
        found = {channel: name for channel, name in names.items() if name is not None}
        return found or {channel: f"servo {channel}" for channel in DEFAULT_CHANNELS if channel not in names}

    @property
    def functions(self) -> Mapping[int, float]:
        """Output -> its SERVOn_FUNCTION, as far as it is known."""
        found = ((channel, self._params.params.get(name)) for channel, name in PARAMS.items())
        return {channel: param.value for channel, param in found if param is not None}

    def receive(self, received: Received, now: float) -> None:
        """Handle a PARAM_VALUE; other messages and other parameters are ignored."""
        if isinstance(received.message, m.ParamValue) and received.message.param_id in PARAMS.values():
            self._params.receive(received, now)

    def tick(self, now: float) -> list[Outgoing]:
        """Return the read requests that are due."""
        if not self._requested:
            self._requested = True
            for name in PARAMS.values():
                self._params.read(name, now)
        self._params.tick(now)
        return self._params.messages_to_send()
