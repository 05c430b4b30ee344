"""Two real ground stations with the same ids on one real vehicle: one drives, the other is named and may stop."""

from __future__ import annotations

import os
import signal
from collections.abc import Iterator
from contextlib import ExitStack
from pathlib import Path

import pytest

from groundstation.intents.driving import Stop
from groundstation.intents.session import ReportKeyReleases
from groundstation.snapshot import Snapshot
from tests.e2e.programs import Vehicle
from tests.groundstation.screen import FORWARD, Screen
from tests.ports import free_port
from tests.waits import wait_until

pytestmark = [pytest.mark.e2e, pytest.mark.slow]


class Twins:
    """`driver` drives the rover ahead; `twin` has the same system and component id."""

    def __init__(self, folder: Path, stack: ExitStack) -> None:
        port = free_port()
        self.vehicle = Vehicle(folder, f"udpin:127.0.0.1:{port}")
        stack.callback(self.vehicle.end)
        endpoint = f"udpout:127.0.0.1:{port}"
        self.driver = stack.enter_context(Screen(endpoint, system=255))
        self.driver.hold_forward()
        self.see_wheels_turn()
        self.twin = stack.enter_context(Screen(endpoint, system=255))

    def see_wheels_turn(self) -> None:
        """Press the key again if the machine held the driver up for so long that it has to be pressed anew."""
        self.driver.turn_wheels(self.vehicle.turning)


@pytest.fixture
def twins(tmp_path: Path) -> Iterator[Twins]:
    with ExitStack() as stack:
        yield Twins(tmp_path, stack)


def in_control(seen: Snapshot) -> bool:
    return seen.vehicle is not None and seen.vehicle.in_control


def test_a_twin_is_told_of_the_driver_and_its_keys_move_nothing(twins: Twins) -> None:
    seen = twins.twin.see(lambda seen: seen.vehicle is not None and seen.vehicle.duplicate_gcs)
    assert not in_control(seen)
    twins.twin.client.send(ReportKeyReleases(), FORWARD)
    blocked = twins.twin.see(lambda seen: "another program with our id 255" in seen.operator.gate_reason)
    assert not blocked.operator.sending
    twins.see_wheels_turn()
    twins.driver.client.send(Stop())
    wait_until(twins.vehicle.stands)
    assert in_control(twins.driver.snapshot)


def test_a_twin_drives_after_the_driver_is_killed_by_a_fresh_key(twins: Twins) -> None:
    twins.twin.see(lambda seen: seen.vehicle is not None and seen.vehicle.duplicate_gcs)
    twins.twin.client.send(ReportKeyReleases(), FORWARD)
    os.kill(twins.driver.client.pid, signal.SIGKILL)
    wait_until(twins.vehicle.stands)
    twins.twin.see(in_control)
    assert not twins.vehicle.turning()  # the key that was held all along
    twins.twin.turn_wheels(twins.vehicle.turning)
