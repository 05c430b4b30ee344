"""Writes the table of what mission commands need, from the definition of MAV_CMD.

    python -m dialects.command_params > groundstation/ui/map/plan/mission_commands.py

The screen's process does not load the dialect, so that the table is a module of its own there. A test compares it with
the installed definitions.
"""

from __future__ import annotations

import sys
import xml.etree.ElementTree as ET
from collections.abc import Iterator
from pathlib import Path

import pymavlink

DEFINITION = Path(pymavlink.__file__).parent / "dialects" / "v20" / "common.xml"
PREFIXES = ("NAV_", "CONDITION_", "DO_")
"""Commands that a plan may hold."""
_EMPTY = ("", "Empty", "Reserved")

_HEAD = '''"""What the commands of a plan need: labels, units and ranges of their parameters.

Written by dialects/command_params.py from the definition of MAV_CMD (common.xml); do not edit.
"""

from __future__ import annotations

from groundstation.ui.map.plan.mission_command import CommandParam, MissionCommand

_P = CommandParam

MISSION_COMMANDS: dict[int, MissionCommand] = {
'''
_TAIL = '''}  # fmt: skip
"""MAV_CMD -> what it needs."""
'''


def write_module(definition: Path = DEFINITION) -> str:
    """Return the text of groundstation/ui/map/plan/mission_commands.py."""
    commands = next(each for each in ET.parse(definition).iter("enum") if each.get("name") == "MAV_CMD")
    rows = sorted((int(entry.get("value", "0")), entry) for entry in commands.iter("entry") if _is_item(entry))
    return _HEAD + "".join(line for number, entry in rows for line in _row(number, entry)) + _TAIL


def _is_item(entry: ET.Element) -> bool:
    return entry.get("name", "").removeprefix("MAV_CMD_").startswith(PREFIXES)


def _row(number: int, entry: ET.Element) -> Iterator[str]:
    name, located = entry.get("name", "").removeprefix("MAV_CMD_"), entry.get("hasLocation") == "true"
    params = [param for param in entry.iter("param") if not (located and int(param.get("index", "0")) > 4)]
    used = [text for param in params if (text := _param(param))]
    yield f'    {number}: MissionCommand("{name}", {located}, ('
    yield "\n" if used else ""
    yield from (f"        {text},\n" for text in used)
    yield "    )),\n" if used else ")),\n"


def _param(param: ET.Element) -> str:
    label = param.get("label") or ""
    if param.get("reserved") == "true" or not label or label in _EMPTY:
        return ""
    found = [repr(float(value)) if (value := param.get(name)) else "None" for name in _LIMITS]
    while found and found[-1] == "None":
        found.pop()
    words = [str(int(param.get("index", "0"))), _quoted(label.lower()), *([_quoted(param.get("units") or "")])]
    return f"_P({', '.join([*words, *found])})"


_LIMITS = ("minValue", "maxValue", "increment")


def _quoted(text: str) -> str:
    return '"' + text.replace('"', "'") + '"'


if __name__ == "__main__":
    sys.stdout.write(write_module())
