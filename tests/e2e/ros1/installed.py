"""Fail unless all of ROS 1 that the tests use is installed: a script for the system's Python, run by .ci/run too.

Debian has each of these in a package of its own, and a machine may have some of them.
"""

from __future__ import annotations

import shutil
from importlib import import_module

MODULES = (
    "rosgraph", "roslaunch", "rosmaster", "rospkg", "rospy",
    "geometry_msgs.msg", "nav_msgs.msg", "rosgraph_msgs.msg", "sensor_msgs.msg", "std_msgs.msg",
)  # fmt: skip
NODE = "rosout"
"""The node that roscore starts."""


def main() -> None:
    """Import all modules. Raises ImportError, rospkg.ResourceNotFound, SystemExit."""
    for name in MODULES:
        import_module(name)
    import_module("rospkg").RosPack().get_path(NODE)
    if shutil.which("roscore") is None:
        raise SystemExit("roscore is not in the search path")


if __name__ == "__main__":
    main()
