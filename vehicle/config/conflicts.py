"""Two parts of a file that want the same pin, chip or port: on its own each is right, together they do not start.

A type of settings that takes something has a property `taken`, its names; a driver of somebody else's may have one.
What several may have together, where they say the same of it, is in its `shared`: name -> what it says.
An accessory keeps away from all that motors hang on, also from pins that they only may come out at: it must never move
one.
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
from vehicle.motors import MotorError
from vehicle.motors.drivers import profile_settings, settings_type
from vehicle.motors.settings import CommonMotorSettings, pin_name, port_name
from vehicle.sensors.suite import SensorSettings


def find_conflicts(table: Mapping[str, Any]) -> list[str]:
    """A line for each thing that is taken twice. `table` is the whole file, right in all its parts."""
    holders: dict[str, tuple[str, str | None]] = {}
    problems = []
    for holder, name, word in _taken(table):
        first, said = holders.setdefault(name, (holder, word))
        if first == holder or (word is not None and word == said):
            continue
        if word is None or said is None:
            problems.append(f"{holder}: {name} is taken by {first} already; one of them needs another")
        else:
            problems.append(f"{holder}: {name} is {said} in {first}; say the same here")
    return problems + _near_motors(table)


def find_motor_conflicts(outputs: Iterable[AccessorySpec], kind: DriveType) -> list[str]:
    """A line for each servo that has the number of a motor."""
    motors = MIXERS[kind].servos
    return [
        f"accessories: {output.name} is a motor where DRIVE_TYPE is {kind:d}; it needs another number"
        for output in outputs
        if output.kind == "servo" and output.number in motors
    ]


def _taken(table: Mapping[str, Any]) -> Iterator[tuple[str, str, str | None]]:
    """Holder, what it takes, and what it says of it where others may have it too."""
    for index, text in enumerate(table.get("endpoints", ())):
        if path := parse_endpoint(text).path:
            yield f"endpoints[{index}]", port_name(path), None
    parts = _motors(table["motors"]) if "motors" in table else {}
    sensors = msgspec.convert(table.get("sensors", {}), SensorSettings)
    parts |= {"sensors.encoders": sensors.encoders, "sensors.battery": sensors.battery}
    for holder, settings in [*parts.items(), *_accessories(table)]:
        for name in getattr(settings, "taken", ()):
            yield holder, name, None
        for name, word in getattr(settings, "shared", {}).items():
            yield holder, name, word


def _motors(table: Mapping[str, Any]) -> dict[str, Any]:
    driver = table["driver"]
    settings = {**profile_settings(driver), **{key: value for key, value in table.items() if key != "driver"}}
    around = msgspec.convert({"safety": settings.pop("safety", None)}, CommonMotorSettings)
    try:
        kind = settings_type(driver)
    except MotorError:  # its library is missing: said when the driver is opened
        kind = None
    own = None if kind is None else msgspec.convert(settings, kind)
    return {"motors": own, "motors.safety": around.safety}


def _accessories(table: Mapping[str, Any]) -> Iterator[tuple[str, AccessorySpec]]:
    accessories = msgspec.convert(table.get("accessories", {}), Accessories)
    for kind, at, each in iter_tables(accessories):
        yield at, build_spec(kind, each)


def _near_motors(table: Mapping[str, Any]) -> list[str]:
    """Pins by which motors are spoken to, or at which they may be, depending on an overlay that nobody sees here."""
    motors = _motors(table["motors"])["motors"] if "motors" in table else None
    pins = {pin_name(pin) for pin in getattr(motors, "pins_nearby", ())}
    return [
        f"{holder}: {name} may be the motors'; it needs another"
        for holder, output in _accessories(table)
        for name in output.taken
        if name in pins
    ]
