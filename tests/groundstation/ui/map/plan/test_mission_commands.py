"""The table of mission commands is the one that the installed definitions give."""

from __future__ import annotations

from dialects.command_params import write_table
from groundstation.ui.map.plan.mission_commands import MISSION_COMMANDS, TABLE, CommandParam


def test_the_table_is_that_of_the_definitions() -> None:
    assert TABLE.read_text("utf-8") == write_table()


def test_known_commands() -> None:
    waypoint = MISSION_COMMANDS[16]
    assert (waypoint.name, waypoint.has_location) == ("NAV_WAYPOINT", True)
    assert waypoint.params[0] == CommandParam(1, "hold", "s", 0.0)
    assert [param.label for param in MISSION_COMMANDS[178].params] == ["speed type", "speed", "throttle"]
    assert MISSION_COMMANDS[181].params[0].step == 1.0
    assert {16, 17, 18, 19, 20, 93, 112, 177, 178, 181, 183, 201, 5001, 5003, 5100} <= set(MISSION_COMMANDS)
