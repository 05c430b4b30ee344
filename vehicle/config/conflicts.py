"""Conflicts between parts of the configuration file that use the same pin, chip or port.

Settings that occupy hardware have a property `taken` with its names; a driver from outside may have one too. Hardware
that several parts may share with the same settings is in the property `shared`: name -> those settings.
An accessory must not use any pin of the motors, not even one that they may use, depending on device tree overlays: an
accessory must never move a motor.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from typing import Any

import msgspec

from dialects.enums import DriveType
from link.endpoint import parse_endpoint
from vehicle.accessories.output import AccessorySpec
from vehicle.accessories.settings import Accessories, build_spec, iter_tables
from vehicle.drive.mixer import MIXERS
from vehicle.motors.drivers import profile_settings, settings_type
from vehicle.motors.settings import CommonMotorSettings, pin_name, port_name
from vehicle.sensors.suite import SensorSettings


def find_conflicts(table: Mapping[str, Any]) -> list[str]:
    """Return one line for each conflict. `table` is the whole file, without errors in its sections."""
    owners: dict[str, tuple[str, str | None]] = {}
    problems = []
    for owner, name, shared_as in iter_taken(table):
        first, first_shared_as = owners.setdefault(name, (owner, shared_as))
        if first == owner or (shared_as is not None and shared_as == first_shared_as):
            continue
        if shared_as is None or first_shared_as is None:
            problems.append(f"{owner}: {name} is already used by {first}; change one of them")
        else:
            problems.append(f"{owner}: {name} is {first_shared_as} in {first}; set the same here")
    return problems + _near_motors(table)


def find_motor_conflicts(specs: Iterable[AccessorySpec], kind: DriveType) -> list[str]:
    """Return one line for each servo with the number of a motor."""
    motors = MIXERS[kind].servos
    return [
        f"accessories: {spec.name} is a motor with DRIVE_TYPE {kind:d}; use another number"
        for spec in specs
        if spec.kind == "servo" and spec.number in motors
    ]


def iter_taken(table: Mapping[str, Any]) -> Iterator[tuple[str, str, str | None]]:
    """Yield section, name of its hardware, and the settings for it if it may be shared. `table` as above."""
    for index, text in enumerate(table.get("endpoints", ())):
        if path := parse_endpoint(text).path:
            yield f"endpoints[{index}]", port_name(path), None
    parts = _motors(table["motors"]) if "motors" in table else {}
    sensors = msgspec.convert(table.get("sensors", {}), SensorSettings)
    parts |= {"sensors.encoders": sensors.encoders, "sensors.battery": sensors.battery}
    parts |= {f"sensors.rangefinders[{index}]": each for index, each in enumerate(sensors.rangefinders)}
    parts["sensors.lidar"] = sensors.lidar
    for owner, settings in [*parts.items(), *_accessories(table)]:
        for name in getattr(settings, "taken", ()):
            yield owner, name, None
        for name, shared_as in getattr(settings, "shared", {}).items():
            yield owner, name, shared_as


def _motors(table: Mapping[str, Any]) -> dict[str, Any]:
    driver = table["driver"]
    settings = {**profile_settings(driver), **{key: value for key, value in table.items() if key != "driver"}}
    common = msgspec.convert({"safety": settings.pop("safety", None)}, CommonMotorSettings)
    kind = settings_type(driver)
    own = None if kind is None else msgspec.convert(settings, kind)
    return {"motors": own, "motors.safety": common.safety}


def _accessories(table: Mapping[str, Any]) -> Iterator[tuple[str, AccessorySpec]]:
    accessories = msgspec.convert(table.get("accessories", {}), Accessories)
    for kind, at, each in iter_tables(accessories):
        yield at, build_spec(kind, each)


def _near_motors(table: Mapping[str, Any]) -> list[str]:
    """Return one line for each accessory on a pin that the motors may use, depending on device tree overlays."""
    motors = _motors(table["motors"])["motors"] if "motors" in table else None
    pins = {pin_name(pin) for pin in getattr(motors, "pins_nearby", ())}
    return [
        f"{owner}: {name} may be used by the motors; use another pin"
        for owner, spec in _accessories(table)
        for name in spec.taken
        if name in pins
    ]
