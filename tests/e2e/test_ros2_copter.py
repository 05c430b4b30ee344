"""`mavhelm ros2` flies a copter by Twist; silence and a killed node leave it hovering at its altitude."""

from __future__ import annotations

import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack
from pathlib import Path

import pytest

from dialects import messages as m
from dialects.axes import HOVER
from tests.e2e import ros2_peer
from tests.e2e.ros2_peer import Peer
from tests.e2e.ros2_world import TRY, kill
from tests.fakes.flying import FlyingVehicle
from tests.fakes.lines import on_line
from tests.fakes.multicopters import ArduCopter
from tests.groundstation.watchdog.test_killed_in_the_air import HEIGHT, HOVERS_FOR, LOSS
from tests.ports import free_port
from tests.waits import wait_until

pytestmark = [pytest.mark.e2e, pytest.mark.slow]

ZERO = 0.3
"""s of zeros at the beginning of each try."""


@pytest.fixture
def stack() -> Iterator[ExitStack]:
    with ExitStack() as opened:
        yield opened


def start_node(copter: FlyingVehicle, router: int, stack: ExitStack, log: Path) -> subprocess.Popen[bytes]:
    """Start our node with this copter; it arms."""
    command = [
        sys.executable,
        "-m",
        "groundstation",
        "ros2",
        "-e",
        copter.endpoint,
        "--station",
        "never",
        "--arm",
        "--system",
        "255",
    ]
    command += ["--router", f"tcp/127.0.0.1:{router}", "--wait", "50"]
    with log.open("wb") as output:
        node = subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=output, stderr=output)
    stack.callback(kill, node)
    return node


def last(copter: FlyingVehicle) -> m.ManualControl:
    """Return the newest demand."""
    return copter.all(m.ManualControl)[-1][1]


def assert_hovers(copter: FlyingVehicle) -> None:
    """Neutral has come, and it keeps its altitude for a while."""
    altitude, lowest = copter.altitude, [copter.altitude]
    wait_until(lambda: (last(copter).x, last(copter).z) == (0, HOVER))
    began = time.monotonic()

    def watched() -> bool:
        lowest.append(copter.altitude)
        return time.monotonic() > began + HOVERS_FOR

    wait_until(watched)
    assert min(lowest) > altitude - LOSS
    assert copter.lowest_z >= HOVER
    assert copter.armed


def test_a_twist_flies_and_its_end_hovers(stack: ExitStack, tmp_path: Path) -> None:
    log = tmp_path / "node.log"
    router = free_port()
    stack.callback(kill, ros2_peer.start("router", router))
    peer = Peer(router)
    stack.callback(peer.close)
    copter = stack.enter_context(on_line(ArduCopter(), "udpin"))
    node = start_node(copter, router, stack, log)

    def publish_until(condition: Callable[[], bool], forward: float = 0.0, up: float = 0.0) -> None:
        began = time.monotonic()

        def published() -> bool:
            if (time.monotonic() - began) % TRY < ZERO:
                peer.twist(0.0)  # as it must where our node was late
            else:
                peer.twist(forward, up=up)
            return condition()

        wait_until(published, log.read_text)

    wait_until(lambda: copter.armed, log.read_text)
    copter.lift(HEIGHT)
    publish_until(lambda: copter.altitude > HEIGHT + 0.5, up=1.0)
    assert_hovers(copter)
    publish_until(lambda: copter.speed > 1.0, forward=3.0)
    node.kill()
    assert_hovers(copter)
