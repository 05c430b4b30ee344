"""From a table of settings, as a TOML file has it, to checked values; and what may be put around any driver."""

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
    """As vehicle/config/conflicts.py knows a pin."""
    return f"GPIO {number}"


def chip_name(bus: int, address: int) -> str:
    """As vehicle/config/conflicts.py knows a chip."""
    return f"address 0x{address:02x} on I2C bus {bus}"


def channel_name(number: int, chip: str) -> str:
    """As vehicle/config/conflicts.py knows an output of a chip."""
    return f"channel {number} at {chip}"


def port_name(path: str) -> str:
    """As vehicle/config/conflicts.py knows a serial port: /dev/serial0 is another name of one."""
    return os.path.realpath(path)


def uart_pins(path: str) -> tuple[int, ...]:
    """Pins of the header at which a serial port may come out; none for one of USB."""
    return (14, 15) if path.startswith(HEADER_UARTS) or port_name(path).startswith(HEADER_UARTS) else ()


def i2c_pins(bus: int) -> tuple[int, ...]:
    """Pins of the header at which an I2C bus may come out."""
    return I2C_PINS.get(bus, ())


HEADER_UARTS = ("/dev/serial", "/dev/ttyAMA", "/dev/ttyS")
I2C_PINS = {0: (0, 1), 1: (2, 3)}
"""Without overlays."""


class SafetyPinSettings(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """Pins beside the motors: an emergency stop, a power switch and a sign of life (vehicle/motors/safety_pins.py)."""

    estop_pin: Pin | None = None
    """Normally closed contact to ground; open, a broken wire too, is stop."""
    enable_pin: Pin | None = None
    """High while the motors may turn: standby of the bridges, output enable, a relay."""
    enable_active_high: bool = True
    """False for an enable that is active low, such as OE of a PCA9685."""
    heartbeat_pin: Pin | None = None
    """Changes with each write to enabled motors; a retriggerable timer cuts the power when it stands still."""

    @property
    def pins(self) -> list[int]:
        """Those that are used."""
        return [pin for pin in (self.estop_pin, self.enable_pin, self.heartbeat_pin) if pin is not None]

    def __post_init__(self) -> None:
        reject_duplicates(self.pins)

    @property
    def taken(self) -> list[str]:
        """Pins."""
        return [pin_name(pin) for pin in self.pins]


class CommonMotorSettings(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """What every driver takes beside its own settings."""

    safety: SafetyPinSettings | None = None

    def open_safety_pins(self) -> SafetyPins | None:
        """The safety pins, with the power off. Raises MotorError."""
        if self.safety is None:
            return None
        from vehicle.motors.safety_pins import SafetyPins

        return SafetyPins(self.safety)

    def wrap(self, motors: Motors, guard: SafetyPins | None) -> Motors:
        """`motors` with all this around them."""
        if guard is None:
            return motors
        from vehicle.motors.safety_pins import GuardedMotors

        return GuardedMotors(motors, guard)


class NoSettings(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """Of a driver that has none of its own."""


def split_table(table: Mapping[str, Any]) -> tuple[CommonMotorSettings, dict[str, Any]]:
    """What goes around the driver, and the rest, which is its own. Raises MotorSettingsError."""
    names = CommonMotorSettings.__struct_fields__
    around = convert({key: value for key, value in table.items() if key in names}, CommonMotorSettings)
    return around, {key: value for key, value in table.items() if key not in names}


def convert(table: Mapping[str, Any], kind: type[T]) -> T:
    """`table` as a `kind`. Raises MotorSettingsError, one line that says where."""
    try:
        return msgspec.convert(dict(table), kind)
    except msgspec.ValidationError as error:
        raise MotorSettingsError(f"motor settings{format_validation_error(error)}") from error


def format_validation_error(error: msgspec.ValidationError) -> str:
    """What is wrong and where, to stand after the name of the table."""
    what, _, path = str(error).partition(" - at `$")
    where = path.strip(".`")
    return f": {where}: {what}" if where else f": {what}"


def reject_duplicates(numbers: list[int]) -> None:
    """Raises ValueError where a pin or channel has two jobs."""
    doubles = sorted({number for number in numbers if numbers.count(number) > 1})
    if doubles:
        raise ValueError(f"{', '.join(map(str, doubles))} is used twice")
