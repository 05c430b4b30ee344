"""Two parts of a file that want the same pin, chip or port: on its own each is right, together they do not start.

A type of settings that takes something has a property `taken`, its names; a driver of somebody else's may have one.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

import msgspec

from link.endpoint import parse
from vehicle.motors import PROFILES, MotorError, settings_type
from vehicle.motors.settings import Around, port_name
from vehicle.sensors.suite import SensorSettings


def clashes(table: Mapping[str, Any]) -> list[str]:
    """A line for each thing that is taken twice. `table` is the whole file, right in all its parts."""
    holders: dict[str, str] = {}
    problems = []
    for holder, name in _taken(table):
        first = holders.setdefault(name, holder)
        if first != holder:
            problems.append(f"{holder}: {name} is taken by {first} already; one of them needs another")
    return problems


def _taken(table: Mapping[str, Any]) -> Iterator[tuple[str, str]]:
    for index, text in enumerate(table.get("endpoints", ())):
        if path := parse(text).path:
            yield f"endpoints[{index}]", port_name(path)
    parts = _motors(table["motors"]) if "motors" in table else {}
    sensors = msgspec.convert(table.get("sensors", {}), SensorSettings)
    parts |= {"sensors.encoders": sensors.encoders, "sensors.battery": sensors.battery}
    for holder, settings in parts.items():
        for name in getattr(settings, "taken", ()):
            yield holder, name


def _motors(table: Mapping[str, Any]) -> dict[str, Any]:
    driver = table["driver"]
    settings = {**PROFILES.get(driver, {}), **{key: value for key, value in table.items() if key != "driver"}}
    around = msgspec.convert({"safety": settings.pop("safety", None)}, Around)
    try:
        kind = settings_type(driver)
    except MotorError:  # its library is missing: said when the driver is opened
        kind = None
    own = None if kind is None else msgspec.convert(settings, kind)
    return {"motors": own, "motors.safety": around.safety}
