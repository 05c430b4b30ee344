"""The table of the verbs in this room.

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


VERBS: dict[str, Verb] = {
    "ros1": Verb(Group.LINKS, (
        Example("mavhelm ros1 --arm", "a node of ROS 1: /command and /cmd_vel drive; docs/ros.md", Stage.MOVING),
    ), {ONLY: VerbAction("be a node of ROS 1: /command and /cmd_vel drive, telemetry is published; until Ctrl-C",
        ros1.run, ros1.ARGUMENTS, needs_session=True, guarded=lambda _: True, companion=ros1.serve)}),
    "ros2": Verb(Group.LINKS, (
        Example("mavhelm ros2 --arm --max-speed 0.5", "a node of ROS 2: /cmd_vel drives; docs/ros.md", Stage.MOVING),
    ), {ONLY: VerbAction(
        "be a node of ROS 2 over rmw_zenoh: /cmd_vel and /command drive, telemetry is published; until Ctrl-C",
        ros2.run, ros2.ARGUMENTS, needs_session=True, prepare=ros2.prepare, guarded=lambda _: True,
        companion=ros2.serve)}),
}  # fmt: skip
"""Verb -> its row."""
