"""Fields of an item: what can be edited, as text with unit, and what is wrong with a text."""

from __future__ import annotations

import math

import msgspec

from groundstation.geo import MAX_LATITUDE, MAX_LONGITUDE
from groundstation.ui.map.plan.commands import CIRCLES, DO_JUMP, POLYGONS, command_title, describe_command, has_location
from groundstation.ui.map.plan.geometry import DEGREES_SCALE, GLOBAL_FRAMES, UNSET
from groundstation.ui.map.plan.mission_commands import CommandParam
from groundstation.views.plan import PlanItem
from link.services.param.float32 import as_float32

LOCAL_SCALE = 1e4
MISSION_FRAME, RELATIVE = 2, 3
FRAMES = {0: "above sea level", 1: "local", 2: "none", 3: "relative to home", 5: "above sea level",
          6: "relative to home", 10: "above terrain", 11: "above terrain"}  # fmt: skip
"""MAV_FRAME in words."""
_LARGEST = 3.4e38
"""Larger numbers do not fit into a float32."""


class ItemField(msgspec.Struct, frozen=True):
    """One editable value of an item."""

    key: str
    """"command", "x", "y", "z", or "1" to "4" for a parameter."""
    label: str
    unit: str = ""
    low: float | None = None
    high: float | None = None
    step: float | None = None

    @property
    def limits(self) -> str:
        """The range in words; empty without one."""
        if self.low is not None and self.high is not None:
            return f"{self.low:g} to {self.high:g}"
        return f"{self.low:g} or more" if self.low is not None else f"up to {self.high:g}" if self.high else ""


_LATITUDE = ItemField("x", "latitude", "", -MAX_LATITUDE, MAX_LATITUDE)
_LONGITUDE = ItemField("y", "longitude", "", -MAX_LONGITUDE, MAX_LONGITUDE)
_ALTITUDE = ItemField("z", "altitude", "m")
_RAW_KEYS = {5: "x", 6: "y", 7: "z"}


def fields_of(item: PlanItem) -> tuple[ItemField, ...]:
    """Return the fields of an item, the command first. An unknown command has all seven parameters as numbers."""
    known, command = describe_command(item.command), ItemField("command", "command")
    if known is None:
        return (command, *(ItemField(_RAW_KEYS.get(number, str(number)), f"param{number}") for number in range(1, 8)))
    used = tuple(_param_field(param) for param in known.params if item.command not in POLYGONS)
    place: tuple[ItemField, ...] = (
        (_LATITUDE, _LONGITUDE, _ALTITUDE) if known.has_location and item.frame in GLOBAL_FRAMES else ()
    )
    if known.has_location and not place:
        place = tuple(ItemField(_RAW_KEYS[number], f"param{number}") for number in (5, 6, 7))
    return (command, *place, *used)


def _param_field(param: CommandParam) -> ItemField:
    key = _RAW_KEYS.get(param.number, str(param.number))
    return ItemField(key, param.label, param.unit, param.low, param.high, param.step)


def value_of(item: PlanItem, field: ItemField, first: int = 0) -> str:
    """Return a value as it is typed; `first` is the number of the first item, for the target of DO_JUMP."""
    if field.key == "command":
        return command_title(item.command)
    if field.key in ("x", "y"):
        return _coordinate(item.x if field.key == "x" else item.y, item.frame)
    value = item.z if field.key == "z" else item.params[int(field.key) - 1]
    if item.command == DO_JUMP and field.key == "1" and math.isfinite(value):
        value += first
    return number_text(value)


def number_text(value: float) -> str:
    """Return a float32 with no more digits than it has; "--" for NaN, which leaves the value to the vehicle."""
    if math.isnan(value):
        return "--"
    texts = (f"{float(f'{value:.{digits}g}'):.9g}" for digits in range(1, 9))
    return next((text for text in texts if as_float32(float(text)) == as_float32(value)), f"{value:.9g}")


def change_field(item: PlanItem, field: ItemField, text: str, first: int = 0) -> PlanItem | str:
    """Return the item with another value; a text that cannot be used gives what is wrong with it, one line."""
    value = _parse(text.strip())
    if isinstance(value, str):
        return value
    if fault := range_fault(field, value):
        return fault
    if field.key in ("x", "y"):
        return _set_coordinate(item, field, value)
    if field.key == "z":
        if math.isnan(value):
            return "the altitude must be a number"
        return msgspec.structs.replace(item, z=as_float32(value))
    if item.command == DO_JUMP and field.key == "1":
        value -= first
        if not value >= 0:
            return f"there is no item {text.strip()}"
    params = list(item.params)
    params[int(field.key) - 1] = as_float32(value)
    return msgspec.structs.replace(item, params=tuple(params))


def change_command(item: PlanItem, command: int) -> PlanItem:
    """Return the item with another command: parameters start anew, a position stays where the command has one."""
    located, has_place = has_location(command), item.frame in GLOBAL_FRAMES
    params = (5.0 if command in CIRCLES else item.params[0] if command in POLYGONS else 0.0, 0.0, 0.0, 0.0)
    frame = (item.frame if has_place else RELATIVE) if located else MISSION_FRAME
    x, y = (item.x, item.y) if located and has_place else (0, 0)
    return PlanItem(command, frame, params, x, y, item.z if located else 0.0, item.autocontinue)


def range_fault(field: ItemField, value: float) -> str:
    """Return why a value is out of the range of its field; empty if it is not."""
    if math.isnan(value):
        return f"{field.label} must be a number" if field.key in ("x", "y") else ""
    if (field.low is not None and value < field.low) or (field.high is not None and value > field.high):
        return f"{field.label} is {field.limits}{' ' + field.unit if field.unit else ''}"
    if field.step == 1.0 and value != int(value):
        return f"{field.label} is a whole number"
    return ""


def _parse(text: str) -> float | str:
    if text.lower() in ("--", "nan"):
        return math.nan
    try:
        value = float(text)
    except ValueError:
        return f"{text!r} is not a number"
    return value if abs(value) <= _LARGEST else f"{text!r} is too large"


def _set_coordinate(item: PlanItem, field: ItemField, value: float) -> PlanItem | str:
    scale = DEGREES_SCALE if item.frame in GLOBAL_FRAMES else 1 if item.frame == MISSION_FRAME else LOCAL_SCALE
    number = round(value * scale)
    if not -UNSET - 1 <= number <= UNSET:
        return f"{field.label} is too large"
    return msgspec.structs.replace(item, **{field.key: number})


def _coordinate(value: int, frame: int) -> str:
    if value == UNSET:
        return "--"
    if frame in GLOBAL_FRAMES:
        return f"{value / DEGREES_SCALE:.7f}"
    return f"{value / LOCAL_SCALE:g}" if frame != MISSION_FRAME else str(value)
