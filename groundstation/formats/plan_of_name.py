"""Reads and writes a plan in the format that the name of its file says: QGC WPL 110, else .plan."""

from __future__ import annotations

from pathlib import PurePath

from groundstation.formats.plan import Plan
from groundstation.formats.plan_file import format_plan, parse_plan
from groundstation.formats.waypoint_file import format_waypoints, lost_values, parse_waypoints

WAYPOINT_SUFFIXES = (".waypoints", ".txt", ".wpl")
"""Of QGC WPL 110; anything else is a .plan."""


def parse_named(text: str, name: str) -> Plan:
    """Parse the text of a file. Raises FileFormatError, with the name and the place in it."""
    return (parse_waypoints if _is_waypoints(name) else parse_plan)(text, name)


def format_named(plan: Plan, name: str) -> str:
    """Return the text of a file."""
    return (format_waypoints if _is_waypoints(name) else format_plan)(plan)


def lost_in_named(plan: Plan, name: str) -> str:
    """Return what the format of a file cannot keep of a plan, in words; "" if it keeps all."""
    return lost_values(plan) if _is_waypoints(name) else ""


def _is_waypoints(name: str) -> bool:
    return PurePath(name).suffix.lower() in WAYPOINT_SUFFIXES
