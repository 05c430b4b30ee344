"""Other ground stations on a vehicle of a fleet: QGroundControl's stand-in and MAVProxy, each behind a bridge."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Iterator
from contextlib import ExitStack
from pathlib import Path

import pytest

from dialects.enums import Command, Result
from tests.e2e.fleet_programs import RouterProcess, make_fleet
from tests.e2e.programs import Vehicle
from tests.interop import mavproxy as mavproxy_program
from tests.interop.qgroundcontrol import QGroundControl
from tests.ports import free_port
from tests.waits import PATIENCE, wait_until
from vehicle.params import TABLE

pytestmark = [pytest.mark.interop, pytest.mark.slow]


class FleetRover:
    """A rover behind a router with certificates, and a bridge that brings alice's part of it to a UDP port."""

    def __init__(self, folder: Path, stack: ExitStack) -> None:
        fleet = make_fleet(folder, rover1="vehicle", alice="setup")
        RouterProcess(fleet, stack)
        self.vehicle = Vehicle(folder, f"zenoh:{fleet}/rover1.json5/farm/rover1")
        stack.callback(self.vehicle.end)
        self.port = free_port()
        ends = (f"zenoh:{fleet}/alice.json5/farm", f"udpout:127.0.0.1:{self.port}")
        with (folder / "bridge.log").open("wb") as log:
            bridge = subprocess.Popen([sys.executable, "-m", "link.bridge", *ends], stdout=log, stderr=log)
        stack.callback(bridge.wait, PATIENCE)
        stack.callback(bridge.terminate)


@pytest.fixture
def rover(tmp_path: Path) -> Iterator[FleetRover]:
    with ExitStack() as stack:
        yield FleetRover(tmp_path, stack)


def test_qgroundcontrol_connects_arms_and_drives(rover: FleetRover) -> None:
    with QGroundControl(rover.port) as ground:
        ground.meet()
        assert {"MANUAL", "HOLD"} <= set(ground.modes())
        assert list(ground.parameters()) == [parameter.name for parameter in TABLE]
        assert ground.command(Command.COMPONENT_ARM_DISARM, 1) is Result.ACCEPTED
        ground.drive(600, until=rover.vehicle.at_full)
        assert ground.joystick(0, until=rover.vehicle.stands)
        assert ground.command(Command.COMPONENT_ARM_DISARM, 0) is Result.ACCEPTED


@mavproxy_program.needed
def test_mavproxy_sets_a_parameter_arms_and_drives(rover: FleetRover, tmp_path: Path) -> None:
    with mavproxy_program.started(rover.port, tmp_path) as mavproxy:
        mavproxy.hear("Received .* parameters")
        mavproxy.say("param set SPEED_MAX 1.4")
        mavproxy.ask("param fetch SPEED_MAX", r"SPEED_MAX = 1\.4")
        mavproxy.say("arm throttle")
        mavproxy.hear("COMPONENT_ARM_DISARM: ACCEPTED")
        mavproxy.say(
            "rc 3 1500"
        )  # neutral first; of demands that wait only the newest counts, so one round trip between
        mavproxy.ask("param fetch SPEED_MAX", r"SPEED_MAX = 1\.4")
        mavproxy.say("rc 3 1600")
        wait_until(lambda: any(each.turning for each in rover.vehicle.outputs()), "the wheels turn")
        mavproxy.say("rc 3 1500")
        wait_until(rover.vehicle.stands, "the wheels stop")
        mavproxy.say("disarm")
        mavproxy.hear("DISARMED")
