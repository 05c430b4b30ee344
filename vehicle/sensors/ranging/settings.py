"""Settings of range sensors: how each is connected. Where it looks is in parameters (RNGFND1_ORIENT, PRX1_YAW_CORR)."""

from __future__ import annotations

import math
from typing import Annotated

import msgspec

from vehicle.motors.settings import Pin, chip_name, pin_name, port_name, reject_duplicates
from vehicle.params import RANGEFINDERS
from vehicle.readings import Cone, Scan

Number = Annotated[int, msgspec.Meta(ge=1, le=RANGEFINDERS, description="n of its parameters RNGFNDn_ORIENT and so on")]
Bus = Annotated[int, msgspec.Meta(ge=0)]
Address = Annotated[int, msgspec.Meta(ge=0x08, le=0x77)]


class Beam(msgspec.Struct, frozen=True):
    """What a sensor of one direction sees."""

    width: float
    """Degrees."""
    near: float
    """m; what is nearer is at 0 m."""
    far: float
    """m to which it sees dark obstacles, too."""

    def scan(self, distance: float | None) -> Scan:
        """Return the scan of a distance in m; infinite: nothing in range, None: not measured."""
        if distance is not None:
            distance = 0.0 if distance < self.near else min(distance, self.far)
        return (Cone(0.0, math.radians(self.width / 2), distance, self.far),)


class Ultrasonic(msgspec.Struct, frozen=True, forbid_unknown_fields=True, tag_field="driver", tag="hc-sr04"):
    """An HC-SR04: ultrasound, 2 cm to 3 m, about 30 degrees wide."""

    number: Number
    trigger: Pin
    echo: Pin
    """Through a divider: the sensor has 5 V, the pin bears 3.3 V."""

    def __post_init__(self) -> None:
        reject_duplicates(self.taken)

    @property
    def taken(self) -> list[str]:
        """The pins by name."""
        return [pin_name(self.trigger), pin_name(self.echo)]


class I2cSettings(msgspec.Struct, frozen=True, forbid_unknown_fields=True, tag_field="driver"):
    """A sensor of ST on the I2C bus. All of them have the same address: a second one needs another bus."""

    number: Number
    bus: Bus = 1
    address: Address = 0x29

    @property
    def taken(self) -> list[str]:
        """The chip by name."""
        return [chip_name(self.bus, self.address)]


class Vl53l0x(I2cSettings, frozen=True, forbid_unknown_fields=True, tag_field="driver", tag="vl53l0x"):
    """A VL53L0X: infrared light, 3 cm to 1.2 m, 25 degrees wide."""


class Vl53l1x(I2cSettings, frozen=True, forbid_unknown_fields=True, tag_field="driver", tag="vl53l1x"):
    """A VL53L1X: infrared light, 4 cm to 3 m, 27 degrees wide; less far in the sun."""


class Tfmini(msgspec.Struct, frozen=True, forbid_unknown_fields=True, tag_field="driver", tag="tfmini"):
    """A TFmini-S, TFmini Plus or TF-Luna on a serial port: infrared light, 10 cm to 4 m, 2 degrees wide."""

    number: Number
    port: str
    """/dev/serial0, or better a name from /dev/serial/by-id."""

    @property
    def taken(self) -> list[str]:
        """The port."""
        return [port_name(self.port)]


Rangefinder = Ultrasonic | Vl53l0x | Vl53l1x | Tfmini


class Lidar(msgspec.Struct, frozen=True, forbid_unknown_fields=True, tag_field="driver", tag="ld06"):
    """An LD06, LD19 or STL-19P on a serial port, which looks all around; PRX1_YAW_CORR turns it."""

    port: str
    """/dev/serial0, or better a name from /dev/serial/by-id."""

    @property
    def taken(self) -> list[str]:
        """The port."""
        return [port_name(self.port)]
