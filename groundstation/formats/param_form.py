"""The forms of parameter files. A module of its own, because the table of verbs needs it, and no parameters."""

from __future__ import annotations

from enum import Enum


class ParamForm(Enum):
    """Whose form a file has."""

    MAVPROXY = "mavproxy"
    QGROUNDCONTROL = "qgc"
    MISSION_PLANNER = "mp"
