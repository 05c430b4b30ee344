"""Relays and servos that nobody serves any more, as after a killed daemon: each to its safe value; never raises."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from vehicle.accessories.drivers import Kind
from vehicle.accessories.settings import COMMON, build_spec
from vehicle.hardware.error_text import format_error


def safe_stop(tables: Any) -> Iterator[tuple[bool, str]]:
    """Try each of [accessories], whatever it holds: is it safe, and a line of what it has now or why nobody knows."""
    for kind in COMMON:
        for index, table in enumerate(_listed(tables, f"{kind}s")):
            try:
                yield True, _made_safe(kind, table)
            except Exception as error:  # whatever it is, the caller has nothing better to do than to say it
                why = format_error(error)
                yield False, f"accessories.{kind}s[{index}]: may have its last value still: {why}"


def _listed(tables: Any, name: str) -> list[Any]:
    found = tables.get(name) if isinstance(tables, Mapping) else None
    return found if isinstance(found, list) else []


def _made_safe(kind: Kind, table: Any) -> str:
    output = build_spec(kind, table)
    accessory = output.make(output.safe)
    accessory.set(output.safe)  # what it was made with is the driver's word only
    accessory.close()
    return f"{output.name}: {output.format_value(output.safe)}"
