"""Intents for the selected vehicle: arming, mode, control, selection."""

from __future__ import annotations

from groundstation.intents.base import Intent
from groundstation.intents.vehicle_intent import Commands, Vehicle, VehicleIntent


class Arm(VehicleIntent, frozen=True):
    """Arm the vehicle, after changing to MANUAL if it is in HOLD."""

    confirmed = "arming"
    held: float = 0.0
    """s for which the key was held; refused below HOLD_TIME."""

    def send(self, commands: Commands[Vehicle], vehicle: Vehicle, now: float) -> None:
        """Begin to arm."""
        commands.arm(vehicle, now)


class Disarm(VehicleIntent, frozen=True):
    """Disarm the vehicle."""

    valid_when_late = open_to_all = True

    def send(self, commands: Commands[Vehicle], vehicle: Vehicle, now: float) -> None:
        """Begin to disarm."""
        commands.disarm(vehicle, now)


class SetMode(VehicleIntent, frozen=True):
    """Change the mode; `mode` is a name of dialects.modes.Mode."""

    neutral = False
    mode: str

    def send(self, commands: Commands[Vehicle], vehicle: Vehicle, now: float) -> None:
        """Request the mode."""
        commands.set_mode(vehicle, self.mode, now)


class RequestControl(Intent, frozen=True):
    """Request to be the ground station in control (MAV_CMD_REQUEST_OPERATOR_CONTROL)."""


class ReleaseControl(Intent, frozen=True):
    """Release control of the selected vehicle: neutral, then it is free for others."""

    valid_when_late = True
    all: bool = False
    """Of every vehicle that we control."""


class GiveControl(Intent, frozen=True):
    """Give control to the ground station that asks for it; without such a request nothing happens."""


class KeepControl(Intent, frozen=True):
    """Refuse the request of another ground station for control."""


class SelectVehicle(Intent, frozen=True):
    """Select the vehicle with this system id."""

    system: int


class SelectNextVehicle(Intent, frozen=True):
    """Select the vehicle with the next higher system id; after the last comes the first."""
