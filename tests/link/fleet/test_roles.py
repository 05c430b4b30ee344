"""Which role a frame needs: never less than our own vehicle asks, and a stop needs none."""

from __future__ import annotations

import pytest

from dialects import messages as m
from dialects import rover
from dialects.axes import Axes, build_manual_control
from dialects.messages import Message
from link.fleet.keys import read_frame
from link.fleet.roles import needed_role
from link.protocol.frame import Frame
from link.signing.role import Role
from tests.link.frames import frame, heartbeat
from tests.vehicle.bench import Bench

STOPS_ONLY = rover.MAV_CMD_DO_FLIGHTTERMINATION
"""Open to anyone; what does not stop does nothing."""


def read(message: Message) -> Frame:
    found = read_frame(frame(message))
    assert found is not None
    return found


def command(number: int, *params: float) -> Frame:
    one, two, three, four, five, six, seven = (*params, *(0.0,) * (7 - len(params)))
    return read(m.CommandLong(1, 1, number, 0, one, two, three, four, five, six, seven))


def files(opcode: int) -> Frame:
    return read(m.FileTransferProtocol(0, 1, 1, [1, 0, 0, opcode, *(0,) * 247]))


@pytest.mark.parametrize(
    ("sent", "role"),
    [
        (read_frame(heartbeat(0)), Role.WATCH),
        (read(m.ParamRequestList(1, 1)), Role.WATCH),
        (command(rover.MAV_CMD_REQUEST_MESSAGE, 148), Role.WATCH),
        (command(rover.MAV_CMD_COMPONENT_ARM_DISARM, 0), Role.WATCH),
        (command(rover.MAV_CMD_DO_FLIGHTTERMINATION, 1), Role.WATCH),
        (read(m.SetMode(1, 1, 4)), Role.WATCH),
        (files(4), Role.WATCH),
        (files(0), Role.WATCH),
        (read(m.SetMode(1, 1, 0)), Role.DRIVE),
        (command(rover.MAV_CMD_COMPONENT_ARM_DISARM, 1), Role.DRIVE),
        (command(rover.MAV_CMD_DO_FLIGHTTERMINATION, 0), Role.DRIVE),
        (read(build_manual_control(Axes(1.0), 1)), Role.DRIVE),
        (read(m.MissionSetCurrent(1, 1, 0)), Role.DRIVE),
        (read(m.ParamSet(1, 1, b"MAN_TIMEOUT", 9.0, 9)), Role.SET_UP),
        (read(m.MissionCount(1, 1, 3)), Role.SET_UP),
        (files(7), Role.SET_UP),
        (command(rover.MAV_CMD_PREFLIGHT_REBOOT_SHUTDOWN, 1), Role.SET_UP),
        ((61000, 255, 190, 0, b""), Role.SET_UP),
    ],
)
def test_what_each_frame_needs(sent: Frame, role: Role) -> None:
    assert needed_role(sent) is role


@pytest.mark.parametrize("number", [42424, 42425, 42426])
def test_a_compass_calibration_of_ardupilot_needs_setup(number: int) -> None:
    """Its start, its acceptance and its end are of ArduPilot's dialect, which is not read here."""
    for first in (0.0, 1.0, 7.0):
        assert needed_role(command(number, first)) is Role.SET_UP


def test_no_command_of_our_vehicle_needs_another_role_than_here() -> None:
    """The router would pass what the vehicle refuses, or refuse what the vehicle allows."""
    rows = Bench().rover.commands
    assert len(rows) > 20
    for row in rows:
        here = max(needed_role(command(row.command, first)) for first in (0.0, 1.0))  # one of them may stop
        assert here == row.needed_role or row.command == STOPS_ONLY, (row.command, row.help)
