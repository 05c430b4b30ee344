"""QGroundControl's connect sequence to its end, and its joystick, by the stand-in of qgroundcontrol.py."""

from __future__ import annotations

import time
from collections.abc import Iterator

import pytest

from dialects import messages as m
from dialects.enums import Capability, Command, Result
from tests.interop import qgc_plans
from tests.interop.conftest import Rover
from tests.interop.qgc_files import LIMIT
from tests.interop.qgroundcontrol import QGroundControl
from tests.waits import PATIENCE, Waits
from vehicle.params import TABLE

pytestmark = pytest.mark.interop


@pytest.fixture
def ground(rover: Rover) -> Iterator[QGroundControl]:
    """The stand-in, connected."""
    with QGroundControl(rover.port) as ground:
        ground.meet()
        yield ground


def test_the_connect_sequence_comes_to_its_end(ground: QGroundControl, rover: Rover) -> None:
    begun, waits = time.monotonic(), Waits(rover.vehicle.process.pid)
    version = ground.request(m.AutopilotVersion)
    assert version.capabilities & Capability.MAVLINK2
    assert {"MANUAL", "HOLD"} <= set(ground.modes())
    meaning = ground.metadata()
    values = ground.parameters()
    assert list(values) == [parameter.name for parameter in TABLE]
    assert set(values) == set(meaning)
    assert (meaning["SPEED_MAX"]["units"], meaning["SPEED_MAX"]["max"]) == ("m/s", 30)
    assert [qgc_plans.count(ground, kind) for kind in (0, 1, 2)] == [0, 0, 0]
    assert time.monotonic() - begun < 15 + waits.total()
    for message in (
        m.ProtocolVersion.id,
        395,
        259,
    ):  # requests of older versions: each gets an answer, none has a time limit
        assert ground.command(Command.REQUEST_MESSAGE, message) in (Result.ACCEPTED, Result.UNSUPPORTED)
    assert ground.command(9999) is Result.UNSUPPORTED
    assert ground.repeats <= waits.total() / LIMIT  # none, except for delays of the machine


def test_its_joystick_drives(ground: QGroundControl, rover: Rover) -> None:
    assert ground.command(Command.COMPONENT_ARM_DISARM, 1) is Result.ACCEPTED
    ground.drive(600, until=rover.vehicle.at_full)
    assert ground.joystick(0, until=rover.vehicle.stands)
    assert ground.command(Command.COMPONENT_ARM_DISARM, 0) is Result.ACCEPTED


def test_a_second_one_drives_only_after_it_was_given_control(ground: QGroundControl, rover: Rover) -> None:
    with QGroundControl(rover.second_port, system=254) as second:
        second.meet()
        assert second.modes()
        assert ground.command(Command.COMPONENT_ARM_DISARM, 1) is Result.ACCEPTED
        told = second.wait(m.ControlStatus, PATIENCE, lambda status: status.gcs_main == 255)
        assert told is not None
        for throttle in (0, 600):
            assert not second.joystick(throttle, until=rover.vehicle.turning, within=0.5)
        assert second.command(Command.REQUEST_OPERATOR_CONTROL, 1, 0) is Result.FAILED
        assert ground.command(Command.REQUEST_OPERATOR_CONTROL, 0, 0) is Result.ACCEPTED
        assert second.command(Command.REQUEST_OPERATOR_CONTROL, 1, 0) is Result.ACCEPTED
        assert second.command(Command.DO_SET_MODE, 1, 0) is Result.ACCEPTED
        second.drive(600, until=rover.vehicle.turning)
