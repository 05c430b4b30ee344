"""What is typed into a field of an item: a value, or the name of another command."""

from __future__ import annotations

from groundstation.ui.map.model import MapModel
from groundstation.ui.map.plan.commands import find_command
from groundstation.ui.map.plan.fields import ItemField, change_command, change_field
from groundstation.views.plan import PlanKind


def choices(model: MapModel, field: ItemField) -> str:
    """Return what can be typed."""
    if field.key != "command":
        limits = f" {field.limits}" if field.limits else ""
        unit = f" in {field.unit}" if field.unit else ""
        return f"{field.label}{unit}{limits}; ENTER keeps it, ESC leaves it"
    if model.editor.layer is PlanKind.FENCE:
        return "polygon in, polygon out, circle in, circle out, return point"
    return "a command: waypoint, loiter, rtl, speed, jump, delay, relay, servo, roi, a name or a number"


def change_item(model: MapModel, field: ItemField, text: str) -> str | None:
    """Change the selected item; return what is wrong with the text."""
    row = model.editor.row
    if row is None or not text.strip():
        return None
    if field.key == "command":
        command = find_command(text, model.editor.layer)
        if isinstance(command, str):
            return command
        if command != row.item.command:
            model.editor.change(change_command(row.item, command))
        return None
    item_or_fault = change_field(row.item, field, text, model.first)
    if isinstance(item_or_fault, str):
        return item_or_fault
    model.editor.change(item_or_fault)
    return None
