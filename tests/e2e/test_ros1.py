"""ROS 1 from Debian's packages drives our rover: the article's command_node, a Twist, and all ways in which it ends."""

from __future__ import annotations

import os
import signal
from collections.abc import Iterator
from contextlib import ExitStack
from pathlib import Path

import pytest

from tests.e2e.ros1.marks import NEEDS_ROS
from tests.e2e.ros1.rig import Rig
from tests.waits import wait_until

pytestmark = [pytest.mark.e2e, NEEDS_ROS]


@pytest.fixture
def rig(tmp_path: Path) -> Iterator[Rig]:
    with ExitStack() as stack:
        yield Rig(tmp_path, stack)


def test_keys_and_twists_drive_until_their_publisher_ends(rig: Rig) -> None:
    """Each key of the article moves the wheels as it says; /cmd_vel does while command_node repeats its stop."""
    node = rig.command_node()
    for key, signs in (("i", (1, 1)), (",", (-1, -1)), ("j", (-1, 1)), ("l", (1, -1))):
        rig.drives(node, key)
        wait_until(lambda signs=signs: _signs(rig) == signs, f"{key}: not {signs}")  # type: ignore[misc]
    rig.presses(node, "k", rig.vehicle.stands)
    twist = rig.script("twist_node.py")
    wait_until(rig.vehicle.turning, f"no Twist drives\n{rig.station.said}")
    for line in ("odom odom", "imu base_link", "fix gps", "battery_state base_link"):
        twist.says(line)
    twist.kill()
    rig.stops()

    rig.drives(node)
    rig.presses(node, "\x03", lambda: node.program.process.poll() is not None)  # it publishes no stop
    rig.stops()
    node = rig.command_node()
    rig.drives(node)
    node.program.kill()
    rig.stops()
    rig.station.process.send_signal(signal.SIGINT)
    assert rig.station.ended() == 128 + signal.SIGINT


def test_the_wheels_stop_when_a_program_between_them_is_killed(rig: Rig) -> None:
    """The master, without which nobody hears of a new publisher; the process with rospy; this program.

    A frozen master is reported, and a publisher that is killed meanwhile stops the wheels all the same.
    """
    node = rig.command_node()
    rig.drives(node)
    os.kill(rig.core.master, signal.SIGSTOP)
    rig.station.says("does not answer")
    wait_until(rig.vehicle.turning, "its publisher drives on")
    node.program.kill()
    rig.stops()
    os.kill(rig.core.master, signal.SIGCONT)
    rig.station.says("answers again")

    rig.drives(rig.command_node())
    os.kill(rig.core.master, signal.SIGKILL)
    rig.stops()
    rig.station.says("the node has left ROS")
    rig.core.end()
    rig.core = rig.start_core()
    node = rig.command_node()
    rig.drives(node)

    [pid] = _nodes(rig)
    os.kill(pid, signal.SIGKILL)
    rig.stops()
    assert rig.station.ended() == 1
    assert "the node of ROS has ended (signal 9); neutral" in rig.station.said

    rig.station = rig.start_station()
    rig.drives(node)
    rig.station.kill()
    rig.stops()
    wait_until(lambda: not _nodes(rig), "its node is left")


def _signs(rig: Rig) -> tuple[int, ...]:
    outputs = rig.vehicle.outputs()
    return tuple((each > 0) - (each < 0) for each in outputs[-1].throttles)


def _nodes(rig: Rig) -> list[int]:
    """Return the processes that run the node of `mavhelm ros1`."""
    master = rig.env["ROS_MASTER_URI"].encode()
    numbers = (each for each in Path("/proc").iterdir() if each.name.isdecimal())
    found = (each for each in numbers if _reads(each / "cmdline", b"ros1/node.py") and _reads(each / "environ", master))
    return [int(each.name) for each in found]


def _reads(path: Path, text: bytes) -> bool:
    try:
        return text in path.read_bytes()
    except OSError:
        return False
