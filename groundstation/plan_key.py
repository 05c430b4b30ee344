"""Whether two items of a plan are the same for a vehicle. Knows no dialect: the screen's process uses it, too.

A vehicle keeps numbers as float32 and answers with frames of its own: ArduPilot with MAV_FRAME_GLOBAL for commands
without a place and for a fence, and without the _INT of a frame.
"""

from __future__ import annotations

import math
from typing import Protocol

from link.services.param.float32 import as_float32

SAME_FRAMES = {5: 0, 6: 3, 11: 10}
"""MAV_FRAME_..._INT -> the frame of the same meaning that vehicles answer with."""

_FENCE = range(5000, 5005)
_SHAPES = range(5001, 5005)
"""Corners and circles have no altitude."""
_LOITER_TIME = 19


class KeyedItem(Protocol):
    """An item of a plan: MissionItem, or PlanItem of the Map screen."""

    @property
    def command(self) -> int:
        """MAV_CMD."""

    @property
    def frame(self) -> int:
        """MAV_FRAME."""

    @property
    def params(self) -> tuple[float, float, float, float]:
        """Parameters 1..4."""

    @property
    def x(self) -> int:
        """Latitude, north, or parameter 5."""

    @property
    def y(self) -> int:
        """Longitude, east, or parameter 6."""

    @property
    def z(self) -> float:
        """Altitude."""


Key = dict[str, int | float | None]
"""Field of MISSION_ITEM_INT -> its value, None for a number that is not set (NaN); equal for equal items."""


def item_key(item: KeyedItem, *, located: bool) -> Key:
    """Return what a vehicle keeps of an item; `located`: its command has a place."""
    key: Key = {"command": item.command, "x": item.x, "y": item.y}
    if located and item.command not in _FENCE:
        key["frame"] = SAME_FRAMES.get(item.frame, item.frame)
    if item.command not in _SHAPES:
        key["z"] = _float32(item.z)
    for number, value in enumerate(item.params, 1):
        key[f"param{number}"] = _float32(value)
    if item.command == _LOITER_TIME and key["param3"] == 0:  # ArduPilot keeps the direction only, as 1 or -1
        key["param3"] = 1.0
    return key


def _float32(value: float) -> float | None:
    return None if math.isnan(value) else as_float32(value)
