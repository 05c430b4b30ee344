"""The table of mission commands is the one that the installed definitions give."""

from __future__ import annotations

from pathlib import Path

from dialects.command_params import write_module
from groundstation.ui.map.plan import mission_commands
from groundstation.ui.map.plan.mission_command import CommandParam
from groundstation.ui.map.plan.mission_commands import MISSION_COMMANDS


def test_the_table_is_that_of_the_definitions() -> None:
    assert Path(mission_commands.__file__).read_text("utf-8") == write_module()


def test_known_commands() -> None:
    waypoint = MISSION_COMMANDS[16]
    assert (waypoint.name, waypoint.has_location) == ("NAV_WAYPOINT", True)
    assert waypoint.params[0] == CommandParam(1, "hold", "s", 0.0)
    assert [param.label for param in MISSION_COMMANDS[178].params] == ["speed type", "speed", "throttle"]
    assert MISSION_COMMANDS[181].params[0].step == 1.0
    assert {16, 17, 18, 19, 20, 93, 112, 177, 178, 181, 183, 201, 5001, 5003, 5100} <= set(MISSION_COMMANDS)
