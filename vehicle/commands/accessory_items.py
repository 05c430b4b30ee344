"""Relays and servos in a mission: what of it this vehicle cannot do, and what is done when its turn comes."""

from __future__ import annotations

from collections.abc import Sequence

from dialects.enums import Command
from link.services.mission.items import Items, MissionItem
from vehicle.commands.accessories import REQUEST_PARSERS, AccessoryCommands


def find_unsupported_items(orders: AccessoryCommands, items: Items) -> list[str]:
    """In words: a plan of another vehicle is driven without what this one has not, as ArduPilot drives it."""
    found = {
        number: why
        for number, item in enumerate(items)
        if item.command in REQUEST_PARSERS and (why := orders.unsupported_reason(item))
    }
    if not found:
        return []
    numbers, reasons = ", ".join(map(str, found)), ", ".join(dict.fromkeys(found.values()))
    return [f"Mission: no accessory for items {numbers}, they will be passed over: {reasons}"]


def execute_items(orders: AccessoryCommands, items: Sequence[MissionItem], now: float) -> list[str]:
    """It is their turn; in words what was passed over."""
    return [
        f"Mission: passed over {Command(item.command).name} {item.params[0]:g}: {why}"
        for item in items
        if (why := orders.execute_item(item, now))
    ]
