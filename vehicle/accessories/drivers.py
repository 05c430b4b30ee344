"""The table of accessory drivers."""

from __future__ import annotations

from typing import Literal

from vehicle.motors.drivers import DriverEntry

AccessoryKind = Literal["relay", "servo"]

DRIVERS: dict[AccessoryKind, dict[str, DriverEntry]] = {
    "relay": {
        "simulated": DriverEntry("vehicle.accessories.simulated:SimulatedAccessory", "no hardware"),
        "gpio": DriverEntry(
            "vehicle.accessories.gpio:GpioRelay", "a relay on a GPIO pin", example={"number": 0, "pin": 16}
        ),
    },
    "servo": {
        "simulated": DriverEntry("vehicle.accessories.simulated:SimulatedAccessory", "no hardware"),
        "pca9685": DriverEntry(
            "vehicle.accessories.pca9685:Pca9685Servo",
            "a servo on a channel of a PCA9685 board (I2C)",
            example={"number": 9, "channel": 0, "address": 0x41},
        ),
    },
}
"""Kind -> name of a driver -> all that the vehicle, `mavhelm vehicle init` and `mavhelm vehicle schema` need of it."""

FIRST_NUMBER: dict[AccessoryKind, int] = {"relay": 0, "servo": 9}
"""Kind -> the number in the example of a driver that gives none; SERVO_OUTPUT_RAW has the motors from 1."""
