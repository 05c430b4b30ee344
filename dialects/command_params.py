"""Write the table of mission commands and their parameters from the definition of MAV_CMD.

    python -m dialects.command_params > groundstation/ui/map/plan/mission_commands.json

A row is a command: its name, whether it has a location, and of each parameter in use the number, the label, the unit,
and, where given, the least value, the greatest value and the increment. A test compares the file with the installed
definitions.
"""

from __future__ import annotations

import json
import sys
import xml.etree.ElementTree as ET
from pathlib import Path

import pymavlink

DEFINITION = Path(pymavlink.__file__).parent / "dialects" / "v20" / "common.xml"
PREFIXES = ("NAV_", "CONDITION_", "DO_")
"""Commands that a plan may hold."""
_EMPTY = ("", "Empty", "Reserved")
_LIMITS = ("minValue", "maxValue", "increment")


def write_table(definition: Path = DEFINITION) -> str:
    """Return the text of groundstation/ui/map/plan/mission_commands.json, one command a line."""
    commands = next(each for each in ET.parse(definition).iter("enum") if each.get("name") == "MAV_CMD")
    rows = sorted((int(entry.get("value", "0")), _command(entry)) for entry in commands.iter("entry"))
    return "{\n" + ",\n".join(f'"{number}": {json.dumps(row)}' for number, row in rows if _is_item(row)) + "\n}\n"


def _is_item(row: list[object]) -> bool:
    return str(row[0]).startswith(PREFIXES)


def _command(entry: ET.Element) -> list[object]:
    located = entry.get("hasLocation") == "true"
    params = [param for param in entry.iter("param") if not (located and int(param.get("index", "0")) > 4)]
    return [
        entry.get("name", "").removeprefix("MAV_CMD_"),
        located,
        [_param(each) for each in params if _is_used(each)],
    ]


def _is_used(param: ET.Element) -> bool:
    return param.get("reserved") != "true" and (param.get("label") or "") not in _EMPTY


def _param(param: ET.Element) -> list[object]:
    limits = [float(value) if (value := param.get(name)) else None for name in _LIMITS]
    while limits and limits[-1] is None:
        limits.pop()
    return [int(param.get("index", "0")), param.get("label", "").lower(), param.get("units") or "", *limits]


if __name__ == "__main__":
    sys.stdout.write(write_table())
