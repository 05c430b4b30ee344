"""`mavhelm ros2` with zenoh-ros2-sdk of ROBOTIS as the other node: it finds the graph and drives."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Iterator
from contextlib import ExitStack
from pathlib import Path

import pytest

pytest.importorskip("zenoh_ros2_sdk", reason="the extra interop is not installed")

from tests.e2e.ros2_world import World, kill

pytestmark = [pytest.mark.interop, pytest.mark.slow]
DRIVE = """
import sys, time
from rosbags.typesys import Stores, get_typestore
from zenoh_ros2_sdk import ROS2Publisher

TWIST = "geometry_msgs/msg/Twist"
store = get_typestore(Stores.ROS2_HUMBLE)
text, _ = store.generate_msgdef(TWIST, ros_version=2)
hash = store.hash_rihs01(TWIST)
publisher = ROS2Publisher("/cmd_vel", TWIST, msg_definition=text, type_hash=hash, router_port=int(sys.argv[1]))
vector = publisher.session_mgr.store.types["geometry_msgs/msg/Vector3"]
while True:
    publisher.publish(linear=vector(x=1.0, y=0.0, z=0.0), angular=vector(x=0.0, y=0.0, z=0.0))
    time.sleep(0.05)
"""


@pytest.fixture
def world(tmp_path: Path) -> Iterator[World]:
    with ExitStack() as stack:
        yield World(tmp_path, stack)


def test_it_lists_our_topics_and_services_and_drives(world: World) -> None:
    world.start("--arm", "--arm-service")
    assert "/odom [nav_msgs/msg/Odometry]\n" in listed(world, "topic")
    assert "/mavhelm_1/arm [std_srvs/srv/SetBool]\n" in listed(world, "service")
    publishers: list[subprocess.Popen[bytes]] = []

    def begin() -> None:
        """Start a publisher in place of the one before, which would have to show zero where our node was late."""
        for each in publishers:
            kill(each)
        command = [sys.executable, "-c", DRIVE, str(world.router)]
        publishers[:] = [subprocess.Popen(command, stdout=subprocess.DEVNULL)]
        world.stack.callback(kill, publishers[0])

    begin()
    world.turns(begin)
    kill(publishers[0])
    world.stands()


def listed(world: World, what: str) -> str:
    program = str(Path(sys.executable).with_name("zenoh-ros2"))
    command = [program, "--no-daemon", "--router", f"127.0.0.1:{world.router}", "--timeout", "5", what, "list", "-t"]
    return subprocess.run(command, capture_output=True, text=True, timeout=60, check=True).stdout
