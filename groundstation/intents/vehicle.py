"""Intents for the selected vehicle: arming, mode, control, selection."""

from __future__ import annotations

from typing import ClassVar

from groundstation.intents.base import Intent
from groundstation.intents.vehicle_intent import Commands, Vehicle, VehicleIntent


class Arm(VehicleIntent, frozen=True):
    """Arm the vehicle, after changing to MANUAL if it is in HOLD."""

    log_text = "arm"
    confirmed = "arming"
    held: float = 0.0
    """s for which the key was held; refused below HOLD_TIME."""

    def send(self, commands: Commands[Vehicle], vehicle: Vehicle, now: float) -> None:
        """Begin to arm."""
        commands.arm(vehicle, now)


class Disarm(VehicleIntent, frozen=True):
    """Disarm the vehicle."""

    log_text = "disarm"
    valid_when_late = open_to_all = True

    def send(self, commands: Commands[Vehicle], vehicle: Vehicle, now: float) -> None:
        """Begin to disarm."""
        commands.disarm(vehicle, now)


LOWEST_TAKE_OFF, HIGHEST_TAKE_OFF = 1.0, 30.0
"""m above the ground to which keys take off."""
TAKE_OFF_ALTITUDE = 3.0
"""m, without the setting for it."""


class TakeOff(VehicleIntent, frozen=True):
    """Take off to an altitude above the ground, and hover there."""

    confirmed = "take-off"
    altitude: float | None = None
    """m; None: as the station is set."""
    held: float = 0.0
    """s for which the key was held; refused below HOLD_TIME."""

    def send(self, commands: Commands[Vehicle], vehicle: Vehicle, now: float) -> None:
        """Begin to take off."""
        commands.take_off(vehicle, self.altitude, now)


CUT_TIME = 2.0
"""s for which the key is held that cuts the motors of what flies."""


class CutMotors(VehicleIntent, frozen=True):
    """Cut the motors in the air: it falls."""

    confirmed = "cutting the motors"
    hold_time: ClassVar[float] = CUT_TIME
    held: float = 0.0
    """s for which the key was held; refused below CUT_TIME."""

    def send(self, commands: Commands[Vehicle], vehicle: Vehicle, now: float) -> None:
        """Cut them."""
        commands.cut_motors(vehicle, now)


class SetMode(VehicleIntent, frozen=True):
    """Change the mode; `mode` is a name of dialects.modes.Mode."""

    log_text = "mode {0.mode}"
    neutral = False
    mode: str

    def send(self, commands: Commands[Vehicle], vehicle: Vehicle, now: float) -> None:
        """Request the mode."""
        commands.set_mode(vehicle, self.mode, now)


class RequestControl(Intent, frozen=True):
    """Request to be the ground station in control (MAV_CMD_REQUEST_OPERATOR_CONTROL)."""

    log_text = "request control"


class ReleaseControl(Intent, frozen=True):
    """Release control of the selected vehicle: neutral, then it is free for others."""

    valid_when_late = True
    all: bool = False
    """Of every vehicle that we control."""

    def describe(self) -> str:
        return "release control of all vehicles" if self.all else "release control"


class GiveControl(Intent, frozen=True):
    """Give control to the ground station that asks for it; without such a request nothing happens."""

    log_text = "give control"


class KeepControl(Intent, frozen=True):
    """Refuse the request of another ground station for control."""

    log_text = "keep control"


class SelectVehicle(Intent, frozen=True):
    """Select the vehicle with this system id."""

    log_text = "select vehicle {0.system}"
    system: int


class SelectNextVehicle(Intent, frozen=True):
    """Select the vehicle with the next higher system id; after the last comes the first."""

    log_text = "select the next vehicle"
