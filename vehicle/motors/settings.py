"""Motor settings: converting a TOML table to checked values, and the settings that all drivers share."""

from __future__ import annotations

import os
from collections.abc import Mapping
from typing import TYPE_CHECKING, Annotated, Any, TypeVar

import msgspec

from vehicle.motors import Motors, MotorSettingsError

if TYPE_CHECKING:
    from vehicle.motors.safety_pins import SafetyPins

Pin = Annotated[int, msgspec.Meta(ge=0, le=27, description="BCM number of a pin of the 40-pin header")]

T = TypeVar("T")


def pin_name(number: int) -> str:
    """Return the name of a pin in vehicle/config/conflicts.py."""
    return f"GPIO {number}"


def chip_name(bus: int, address: int) -> str:
    """Return the name of a chip in vehicle/config/conflicts.py."""
    return f"address 0x{address:02x} on I2C bus {bus}"


def channel_name(number: int, chip: str) -> str:
    """Return the name of a channel of a chip in vehicle/config/conflicts.py."""
    return f"channel {number} at {chip}"


def port_name(path: str) -> str:
    """Return the name of a serial port in vehicle/config/conflicts.py: links such as /dev/serial0 are resolved."""
    return os.path.realpath(path)


def uart_pins(path: str) -> tuple[int, ...]:
    """Return the header pins that a serial port may use; none for a USB port."""
    return (14, 15) if path.startswith(HEADER_UARTS) or port_name(path).startswith(HEADER_UARTS) else ()


def i2c_pins(bus: int) -> tuple[int, ...]:
    """Return the header pins that an I2C bus may use."""
    return I2C_PINS.get(bus, ())


HEADER_UARTS = ("/dev/serial", "/dev/ttyAMA", "/dev/ttyS")
I2C_PINS = {0: (0, 1), 1: (2, 3)}
"""I2C bus -> its header pins without overlays."""


class SafetyPinSettings(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """Safety pins: an emergency stop, a power switch and a heartbeat (vehicle/motors/safety_pins.py)."""

    estop_pin: Pin | None = None
    """Normally closed contact to ground; open, also by a broken wire, means stop."""
    enable_pin: Pin | None = None
    """High while the motors may turn: for the standby input of bridges, an output enable, or a relay."""
    enable_active_high: bool = True
    """False for an enable input that is active low, such as OE of a PCA9685."""
    heartbeat_pin: Pin | None = None
    """Toggles with each write to enabled motors; a retriggerable timer cuts the power when it stops toggling."""

    @property
    def pins(self) -> list[int]:
        """The configured pins."""
        return [pin for pin in (self.estop_pin, self.enable_pin, self.heartbeat_pin) if pin is not None]

    def __post_init__(self) -> None:
        reject_duplicates(self.taken)

    @property
    def taken(self) -> list[str]:
        """The pins by name."""
        return [pin_name(pin) for pin in self.pins]


class CommonMotorSettings(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """Settings that every driver has beside its own."""

    safety: SafetyPinSettings | None = None

    def open_safety_pins(self) -> SafetyPins | None:
        """Open the safety pins, with the power off; None without any. Raises MotorError."""
        if self.safety is None:
            return None
        from vehicle.motors.safety_pins import SafetyPins

        return SafetyPins(self.safety)

    def wrap(self, motors: Motors, guard: SafetyPins | None) -> Motors:
        """Return `motors` behind the safety pins, if there are any."""
        if guard is None:
            return motors
        from vehicle.motors.safety_pins import GuardedMotors

        return GuardedMotors(motors, guard)


class NoSettings(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """Settings of a driver without settings of its own."""


def split_table(table: Mapping[str, Any]) -> tuple[CommonMotorSettings, dict[str, Any]]:
    """Split a table into the common settings and the driver's own. Raises MotorSettingsError."""
    names = CommonMotorSettings.__struct_fields__
    common = convert({key: value for key, value in table.items() if key in names}, CommonMotorSettings)
    return common, {key: value for key, value in table.items() if key not in names}


def convert(table: Mapping[str, Any], kind: type[T]) -> T:
    """Convert `table` to a `kind`. Raises MotorSettingsError with one line that names the key."""
    try:
        return msgspec.convert(dict(table), kind)
    except msgspec.ValidationError as error:
        raise MotorSettingsError(f"motor settings{format_validation_error(error)}") from error


def format_validation_error(error: msgspec.ValidationError) -> str:
    """Return key and error, to follow the name of the table."""
    what, _, path = str(error).partition(" - at `$")
    where = path.strip(".`")
    return f": {where}: {what}" if where else f": {what}"


def reject_duplicates(names: list[str]) -> None:
    """Raise ValueError if a pin or channel, each by its name, is used twice."""
    doubles = [name for name in dict.fromkeys(names) if names.count(name) > 1]
    if doubles:
        raise ValueError(f"{', '.join(doubles)} {'is' if len(doubles) == 1 else 'are'} used twice")
