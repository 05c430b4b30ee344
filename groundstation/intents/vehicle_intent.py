"""VehicleIntent: an intent that is a command to the selected vehicle, and sends it itself.

The station (station/intent_handler.py) checks that there is a vehicle, that the screen may confirm, and goes neutral
first; then it calls `send`. So a new command of the operator is a class here or in vehicle.py, and its row in ACTIONS.
"""

from __future__ import annotations

from typing import ClassVar, Protocol, TypeVar

from groundstation.intents.base import Intent

HOLD_TIME = 1.0
"""s for which the key of an action with `confirm` must be held (input/hold_to_confirm.py); the station checks it."""

Vehicle = TypeVar("Vehicle")
VehicleOf = TypeVar("VehicleOf", contravariant=True)


class Commands(Protocol[VehicleOf]):
    """Commands to a vehicle: station/driving/commander.py. `now` is the monotonic time, s."""

    def send(self, vehicle: VehicleOf, label: str, command: str, *params: float, now: float) -> None:
        """Send the MAV_CMD of this name, with up to 7 parameters; `label` names it in the log and in refusals.

        A name, because the process of the screen does not load the dialect (dialects/enums.py, Command).
        """

    def arm(self, vehicle: VehicleOf, now: float) -> None:
        """Send neutral demands, change from HOLD to MANUAL, then arm."""

    def disarm(self, vehicle: VehicleOf, now: float) -> None:
        """Disarm, and repeat until the heartbeat agrees."""

    def take_off(self, vehicle: VehicleOf, altitude: float | None, now: float) -> None:
        """Take off to an altitude above the ground, m; None: to the one that is set."""

    def cut_motors(self, vehicle: VehicleOf, now: float) -> None:
        """Cut the motors of what flies."""

    def set_mode(self, vehicle: VehicleOf, name: str, now: float) -> None:
        """Change the mode to the one with this name."""

    def clear_emergency_stop(self, vehicle: VehicleOf, now: float) -> None:
        """Release the emergency stop."""


class VehicleIntent(Intent, frozen=True):
    """Base class of the commands to the selected vehicle."""

    neutral: ClassVar[bool] = True
    """Go neutral first: held keys must be pressed again. It is so for what stops the vehicle, and before arming."""
    confirmed: ClassVar[str] = ""
    """Name of what needs a held key: `held` must be at least HOLD_TIME, and the screen must allow keys."""

    hold_time: ClassVar[float] = HOLD_TIME
    """s for which its key must be held, if it needs that."""

    def send(self, commands: Commands[Vehicle], vehicle: Vehicle, now: float) -> None:
        """Send the command."""
        raise NotImplementedError
