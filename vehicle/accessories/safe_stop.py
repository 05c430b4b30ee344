"""Sets relays and servos to their safe values without a running vehicle, for example after the daemon was killed."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from vehicle.accessories.drivers import AccessoryKind
from vehicle.accessories.settings import COMMON, build_spec
from vehicle.hardware.error_text import format_error


def safe_stop(tables: Any) -> Iterator[tuple[bool, str]]:
    """Make each accessory of [accessories] safe, and yield success and a line for each. Never raises."""
    for kind in COMMON:
        for index, table in enumerate(_tables_of(tables, f"{kind}s")):
            try:
                yield True, _make_safe(kind, table)
            except Exception as error:  # any error: the caller can only report it
                reason = format_error(error)
                yield False, f"accessories.{kind}s[{index}]: may still have its last value: {reason}"


def _tables_of(tables: Any, name: str) -> list[Any]:
    found = tables.get(name) if isinstance(tables, Mapping) else None
    return found if isinstance(found, list) else []


def _make_safe(kind: AccessoryKind, table: Any) -> str:
    spec = build_spec(kind, table)
    accessory = spec.make(spec.safe)
    accessory.set(spec.safe)  # a driver from outside may ignore its start value
    accessory.close()
    return f"{spec.name}: {spec.format_value(spec.safe)}"
