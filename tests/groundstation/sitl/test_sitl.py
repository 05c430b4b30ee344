"""The simulator as a child of the station process: started, watched, and ended with it."""

from __future__ import annotations

import os
import signal
from pathlib import Path

import pytest

from groundstation.intents.session import RenewLease, StartSimulator
from groundstation.sitl.sitl import SimulatorControl
from link.endpoint import parse_endpoint
from tests.groundstation.screen import Screen, running, simulators
from tests.ports import free_port
from tests.waits import wait_until

pytestmark = pytest.mark.e2e


def sees_rover(screen: Screen) -> None:
    screen.see(lambda snapshot: snapshot.vehicle is not None and snapshot.vehicle.alive)


@pytest.mark.usefixtures("patient")
def test_sitl_starts_a_rover_on_a_free_port_and_ends_it_with_us() -> None:
    with Screen(sitl=True) as screen:
        sees_rover(screen)
        assert screen.snapshot.simulator == "running"
        (simulator,) = simulators(screen.client.pid)
        assert screen.client.close() == 0
        wait_until(lambda: not running(simulator))


def test_the_simulator_can_be_started_later() -> None:
    with Screen() as screen:
        screen.see(lambda snapshot: snapshot.waiting is not None)
        assert screen.snapshot.simulator is None
        screen.client.send(RenewLease(), StartSimulator())
        sees_rover(screen)
        screen.client.send(StartSimulator())
        seen = screen.snapshot.number
        screen.see(lambda snapshot: snapshot.number > seen + 3)
        assert len(simulators(screen.client.pid)) == 1


def test_the_simulator_records_its_drives_until_it_ends() -> None:
    with Screen(sitl=True) as screen:
        sees_rover(screen)
        (simulator,) = simulators(screen.client.pid)
        words = Path(f"/proc/{simulator}/cmdline").read_bytes().split(b"\0")
        folder = Path(os.fsdecode(words[words.index(b"--tlog") + 1]))
        screen.hold_forward()
        wait_until(lambda: list(folder.glob("*.tlog")))
        assert screen.client.close() == 0
        assert not folder.exists()


def test_an_armed_simulator_that_ended_is_not_left_armed() -> None:
    with Screen(sitl=True) as screen:
        sees_rover(screen)
        screen.hold_forward()
        armed = ("Rover 1 is left ARMED in MANUAL",)
        screen.see(lambda snapshot: snapshot.left_armed == armed)
        assert screen.snapshot.end_armed == armed
        assert screen.client.close() == 0
        assert screen.client.left_armed == ()


def test_the_simulator_dies_with_a_station_that_is_killed() -> None:
    endpoint = f"udpin:127.0.0.1:{free_port()}"
    with Screen(endpoint, sitl=True) as screen:
        sees_rover(screen)
        assert screen.client.endpoints == (endpoint,), "the simulator sends to the port that is given"
        (simulator,) = simulators(screen.client.pid)
        os.kill(screen.client.pid, signal.SIGKILL)
        wait_until(lambda: not running(simulator))


def test_the_exit_of_the_simulator_is_reported() -> None:
    with Screen(sitl=True) as screen:
        sees_rover(screen)
        os.kill(simulators(screen.client.pid)[0], signal.SIGKILL)
        screen.see(lambda snapshot: str(snapshot.simulator).startswith("ended by SIGKILL"))
        assert any("simulator ended by SIGKILL" in line.text for line in screen.snapshot.texts)


def test_a_simulator_needs_a_link_that_listens() -> None:
    control = SimulatorControl()
    error = control.start([parse_endpoint("udpout:127.0.0.1:14550")])
    assert error == "the simulator needs a link that listens, e.g. udpin:127.0.0.1:14550"
    assert control.state is None
    assert control.pop_exit() is None
    control.close()
