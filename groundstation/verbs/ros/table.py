"""The table of the verbs in this room, and of `mavhelm api` and `mavhelm mcp`.

To add a verb, write its function in a module beside this one and add its row to VERBS.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from groundstation.verbs.action import ONLY, VerbAction
from groundstation.verbs.common.lazy import LazyModule
from groundstation.verbs.verb import Example, Group, Stage, Verb

if TYPE_CHECKING:
    from groundstation.verbs.ros import ros1, ros2
else:
    ros1 = LazyModule("ros.ros1")
    ros2 = LazyModule("ros.ros2")


api, agents = LazyModule("api.api"), LazyModule("agents.agents")  # rooms above this one

VERBS: dict[str, Verb] = {
    "api": Verb(Group.LINKS, (
        Example("mavhelm api", "calls as JSON lines on stdin; docs/python.md", Stage.OTHER_VEHICLE),
    ), {ONLY: VerbAction("be driven by a program: calls on stdin, answers on stdout, one JSON object a line", api.run,
        (("--stay-armed", {"action": "store_true", "help": "do not disarm at the end what the program has armed"}),),
        needs_session=True, guarded=lambda _: True, companion=api.serve)}),
    "mcp": Verb(Group.LINKS, (
        Example("mavhelm mcp", "an MCP client starts it; a person at the screen permits; docs/agents.md",
                Stage.OTHER_VEHICLE),
    ), {ONLY: VerbAction("be the tools of an agent (MCP): it reads, and a person holds a key for all else", agents.run,
        watches=True, finds=False, in_station=True, prepare=agents.prepare, companion=agents.serve)}),
    "ros1": Verb(Group.LINKS, (
        Example("mavhelm ros1 --arm", "a node of ROS 1: /command and /cmd_vel drive; docs/ros.md", Stage.STOPPED),
    ), {ONLY: VerbAction("be a node of ROS 1: /command and /cmd_vel drive, telemetry is published; until Ctrl-C",
        ros1.run, ros1.ARGUMENTS, needs_session=True, guarded=lambda _: True, companion=ros1.serve)}),
    "ros2": Verb(Group.LINKS, (
        Example("mavhelm ros2 --arm --max-speed 0.5", "a node of ROS 2: /cmd_vel drives; docs/ros.md", Stage.STOPPED),
    ), {ONLY: VerbAction(
        "be a node of ROS 2 over rmw_zenoh: /cmd_vel and /command drive, telemetry is published; until Ctrl-C",
        ros2.run, ros2.ARGUMENTS, needs_session=True, prepare=ros2.prepare, guarded=lambda _: True,
        companion=ros2.serve)}),
}  # fmt: skip
"""Verb -> its row."""
