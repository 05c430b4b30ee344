"""MAV_CMD_PREFLIGHT_STORAGE: a vehicle stores its parameters, or resets all of them to their defaults."""

from __future__ import annotations

from dialects.enums import Command
from groundstation.vehicles.requests.command_requests import CommandRequests

STORE, RESET = 1.0, 2.0
"""PREFLIGHT_STORAGE_PARAMETER_ACTION in the first parameter of the command."""
KEEP_PLANS = -1.0
"""Second parameter: leave missions alone; any other number than 0 and 1, which would load or store them."""


class ParamStorage:
    """Requests about the memory of the vehicle."""

    def __init__(self, commands: CommandRequests) -> None:
        self._commands = commands

    def store(self, number: int, now: float) -> None:
        """Store all parameters. ArduPilot and PX4 store each one when it is set, too."""
        self._send(number, STORE, "store the parameters", now)

    def reset(self, number: int, now: float) -> None:
        """Reset all parameters to their defaults. Their values are not known until they are fetched again."""
        self._send(number, RESET, "reset the parameters", now)

    def _send(self, number: int, action: float, what: str, now: float) -> None:
        self._commands.send(number, Command.PREFLIGHT_STORAGE, (action, KEEP_PLANS), what, now)
