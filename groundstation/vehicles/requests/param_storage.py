"""MAV_CMD_PREFLIGHT_STORAGE: a vehicle stores its parameters, or resets all of them to their defaults."""

from __future__ import annotations

from collections.abc import Callable

from dialects.enums import Autopilot, Command
from groundstation.vehicles.requests.command_requests import CommandRequests
from groundstation.vehicles.requests.requests import RequestBook

STORE, RESET = 1.0, 2.0
"""PREFLIGHT_STORAGE_PARAMETER_ACTION in the first parameter of the command."""
KEEP_PLANS = -1.0
"""Second parameter: leave missions alone; any other number than 0 and 1, which would load or store them."""


STORES_EACH = "ArduPilot stores each parameter when it is set"


class ParamStorage:
    """Requests about the memory of the vehicle."""

    def __init__(self, commands: CommandRequests, book: RequestBook, autopilot: Callable[[], int]) -> None:
        self._commands = commands
        self._book = book
        self._autopilot = autopilot

    def store(self, number: int, now: float) -> None:
        """Store all parameters. ArduPilot and PX4 store each one when it is set; ArduPilot knows no command for it."""
        if self._autopilot() == Autopilot.ARDUPILOT:
            if self._book.begin(number, "store the parameters"):
                self._book.accept(number, STORES_EACH)
            return
        self._send(number, STORE, "store the parameters", now)

    def reset(self, number: int, now: float) -> None:
        """Reset all parameters to their defaults. Their values are not known until they are fetched again."""
        self._send(number, RESET, "reset the parameters", now)

    def _send(self, number: int, action: float, what: str, now: float) -> None:
        self._commands.send(number, Command.PREFLIGHT_STORAGE, (action, KEEP_PLANS), what, now)
