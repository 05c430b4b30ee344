"""Which role a frame needs: never less than our own vehicle asks, and a stop needs none."""

from __future__ import annotations

import math

import pytest

from dialects import messages as m
from dialects import rover
from dialects.axes import Axes, build_manual_control
from dialects.messages import Message
from link.fleet.keys import read_frame
from link.fleet.rights.drive_commands import DRIVE_COMMANDS
from link.fleet.roles import depends_on_content, file_opcode, needed_role
from link.protocol.frame import Frame
from link.signing.role import SigningRole
from tests.link.frames import frame, heartbeat
from tests.rows import each_row
from tests.vehicle.bench import Bench

MORE = {
    rover.MAV_CMD_DO_FLIGHTTERMINATION: SigningRole.DRIVE,  # ours is open to anyone: what does not stop does nothing
    rover.MAV_CMD_SET_MESSAGE_INTERVAL: SigningRole.DRIVE,  # of the HEARTBEAT; ours changes it for the sender alone
    rover.MAV_CMD_DO_FENCE_ENABLE: SigningRole.SET_UP,  # off; the row of ours names what on needs
    **dict.fromkeys(
        (
            rover.MAV_CMD_VIDEO_START_STREAMING, rover.MAV_CMD_VIDEO_STOP_STREAMING,
            rover.MAV_CMD_REQUEST_CAMERA_INFORMATION, rover.MAV_CMD_REQUEST_VIDEO_STREAM_INFORMATION,
            rover.MAV_CMD_REQUEST_VIDEO_STREAM_STATUS,
        ),
        SigningRole.DRIVE,  # a camera of another make has one stream for all; ours sends one to each address
    ),
}  # fmt: skip
"""Commands of our vehicle that need more here, some for a value of parameter 1, because of other autopilots."""


def read(message: Message) -> Frame:
    found = read_frame(frame(message))
    assert found is not None
    return found


def command(number: int, *params: float) -> Frame:
    one, two, three, four, five, six, seven = (*params, *(0.0,) * (7 - len(params)))
    return read(m.CommandLong(1, 1, number, 0, one, two, three, four, five, six, seven))


def files(opcode: int) -> Frame:
    return read(m.FileTransferProtocol(0, 1, 1, [1, 0, 0, opcode, *(0,) * 247]))


@each_row(
    ("sent", "role"),
    [
        (read_frame(heartbeat(0)), SigningRole.WATCH),
        (read(m.ParamRequestList(1, 1)), SigningRole.WATCH),
        (command(rover.MAV_CMD_REQUEST_MESSAGE, 148), SigningRole.WATCH),
        (command(rover.MAV_CMD_COMPONENT_ARM_DISARM, 0), SigningRole.WATCH),
        (command(rover.MAV_CMD_DO_FLIGHTTERMINATION, 1), SigningRole.WATCH),
        (read(m.SetMode(1, 1, 4)), SigningRole.DRIVE),  # HOLD of some vehicles only: test_circumstances.py
        (command(rover.MAV_CMD_DO_SET_MODE, 1, 4), SigningRole.DRIVE),
        (command(rover.MAV_CMD_DO_SET_MODE, 1, 4, math.nan), SigningRole.DRIVE),
        (read(m.RequestDataStream(1, 1, 0, 4, 1)), SigningRole.DRIVE),
        (command(rover.MAV_CMD_SET_MESSAGE_INTERVAL, 0, -1), SigningRole.DRIVE),
        (command(rover.MAV_CMD_SET_MESSAGE_INTERVAL, math.nan, -1), SigningRole.DRIVE),
        (command(rover.MAV_CMD_SET_MESSAGE_INTERVAL, 0.99, -1), SigningRole.DRIVE),  # 0 for ArduPilot
        (command(rover.MAV_CMD_SET_MESSAGE_INTERVAL, -0.5, -1), SigningRole.DRIVE),
        (command(rover.MAV_CMD_SET_MESSAGE_INTERVAL, 2.0**24, -1), SigningRole.DRIVE),
        (command(rover.MAV_CMD_SET_MESSAGE_INTERVAL, math.inf, -1), SigningRole.DRIVE),
        (command(rover.MAV_CMD_SET_MESSAGE_INTERVAL, 1, 1e5), SigningRole.WATCH),
        (command(rover.MAV_CMD_SET_MESSAGE_INTERVAL, 30, 1e5), SigningRole.WATCH),
        (command(rover.MAV_CMD_SET_MESSAGE_INTERVAL, 2.0**24 - 1, 1e5), SigningRole.WATCH),
        (read(m.MissionAck(1, 1, 0)), SigningRole.DRIVE),
        (read(m.LogRequestEnd(1, 1)), SigningRole.DRIVE),
        (files(2), SigningRole.DRIVE),
        (files(1), SigningRole.WATCH),
        (files(4), SigningRole.WATCH),
        (files(0), SigningRole.WATCH),
        (read(m.SetMode(1, 1, 0)), SigningRole.DRIVE),
        (command(rover.MAV_CMD_COMPONENT_ARM_DISARM, 1), SigningRole.DRIVE),
        (command(rover.MAV_CMD_DO_FLIGHTTERMINATION, 0), SigningRole.DRIVE),
        (read(build_manual_control(Axes(1.0), 1)), SigningRole.DRIVE),
        (read(m.MissionSetCurrent(1, 1, 0)), SigningRole.DRIVE),
        (read(m.ParamSet(1, 1, b"MAN_TIMEOUT", 9.0, 9)), SigningRole.SET_UP),
        (read(m.MissionCount(1, 1, 3)), SigningRole.SET_UP),
        (files(7), SigningRole.SET_UP),
        (command(rover.MAV_CMD_PREFLIGHT_REBOOT_SHUTDOWN, 1), SigningRole.SET_UP),
        ((61000, 255, 190, 0, b""), SigningRole.SET_UP),
        (read(rover.MAVLink_serial_control_message(10, 0, 0, 0, 5, [0] * 70)), SigningRole.SET_UP),
        (read(rover.MAVLink_param_ext_set_message(1, 1, b"CAM_MODE", b"1", 1)), SigningRole.SET_UP),
        (command(rover.MAV_CMD_DO_FENCE_ENABLE, 1), SigningRole.DRIVE),
        (command(rover.MAV_CMD_DO_FENCE_ENABLE, 0), SigningRole.SET_UP),
        (command(rover.MAV_CMD_DO_FENCE_ENABLE, 2), SigningRole.SET_UP),
        (command(rover.MAV_CMD_DO_FENCE_ENABLE, math.nan), SigningRole.SET_UP),
    ],
)
def test_what_each_frame_needs(sent: Frame, role: SigningRole) -> None:
    assert needed_role(sent) is role


READING = {0, 1, 3, 4, 5, 14, 15}


@each_row("opcode", range(20))
def test_only_file_operations_that_read_are_a_watchers(opcode: int) -> None:
    expected = SigningRole.WATCH if opcode in READING else SigningRole.DRIVE if opcode == 2 else SigningRole.SET_UP
    assert needed_role(files(opcode)) is expected
    assert file_opcode(files(opcode)) == opcode


def test_an_opcode_of_zero_is_not_sent() -> None:
    number, system, component, sequence, raw = read(m.FileTransferProtocol(0, 1, 1, [1, 0, 9, *(0,) * 248]))
    assert raw[1] == 6, "bytes of payload: up to the session"
    assert file_opcode((number, system, component, sequence, raw)) == 0


def test_the_role_of_commands_and_files_depends_on_their_content() -> None:
    for number in (m.CommandLong.id, m.CommandInt.id, m.SetMode.id, m.FileTransferProtocol.id):
        assert depends_on_content(number)
    for number in (m.Heartbeat.id, m.ManualControl.id, m.ParamSet.id, m.MissionAck.id):
        assert not depends_on_content(number)


SET_UP_BY_ANOTHER_NAME = {
    180: "DO_SET_PARAMETER",
    212: "DO_AUTOTUNE_ENABLE",
    218: "DO_AUX_FUNCTION",
    420: "INJECT_FAILURE",
    500: "START_RX_PAIR",
    529: "RESET_CAMERA_SETTINGS",
    2600: "CONTROL_HIGH_LATENCY",
    5001: "NAV_FENCE_POLYGON_VERTEX_INCLUSION",
    31010: "USER_1",
    32000: "CAN_FORWARD",
    42650: "FLASH_BOOTLOADER",
    42701: "SCRIPTING",
    50123: "unknown",
    0: "unknown",
}


@each_row("number", SET_UP_BY_ANOTHER_NAME, ids=SET_UP_BY_ANOTHER_NAME.get)
def test_set_up_by_another_name_needs_setup(number: int) -> None:
    for first in (0.0, 1.0, 42.0):
        assert needed_role(command(number, first)) is SigningRole.SET_UP


def test_each_command_that_drive_may_send_is_known() -> None:
    """A range over free numbers would give a new command of set-up to the drivers."""
    known = {number for name, number in vars(rover).items() if name.startswith("MAV_CMD_")}
    assert known >= DRIVE_COMMANDS - {216, 611}
    assert len(DRIVE_COMMANDS) < len(known) * 3 / 4


@pytest.mark.parametrize("number", [42424, 42425, 42426])
def test_a_compass_calibration_of_ardupilot_needs_setup(number: int) -> None:
    """Its start, its acceptance and its end are of ArduPilot's dialect, which is not read here."""
    for first in (0.0, 1.0, 7.0):
        assert needed_role(command(number, first)) is SigningRole.SET_UP


def test_no_command_of_our_vehicle_needs_another_role_than_here() -> None:
    """The router would pass what the vehicle refuses, or refuse what the vehicle allows."""
    rows = Bench().rover.commands
    assert len(rows) > 20
    for row in rows:
        here = max(needed_role(command(row.command, first)) for first in (0.0, 1.0))  # one of them may stop
        assert here == MORE.get(row.command, row.needed_role), (row.command, row.help)


DRIVE_NUMBERS = (
    (16, 25), (30, 36), (80, 80), (82, 82), (84, 85), (92, 94), (115, 115), (176, 179), (181, 198), (200, 208),
    (210, 211), (213, 214), (216, 216), (220, 224), (252, 252), (260, 260), (262, 262), (300, 300), (400, 400),
    (405, 406), (521, 522), (525, 525), (527, 528), (530, 532), (534, 534), (601, 601), (611, 611), (1000, 1001),
    (2000, 2005), (2010, 2010), (2500, 2505), (2510, 2511), (2520, 2520), (2800, 2800), (3000, 3001), (4000, 4001),
    (5300, 5300), (10001, 10001), (30001, 30002), (32100, 32100), (42600, 42600), (43000, 43003),
)  # fmt: skip
"""First and last numbers of the runs of MAV_CMDs that the role drive may send."""


def test_the_commands_of_drivers_by_number() -> None:
    assert {number for first, last in DRIVE_NUMBERS for number in range(first, last + 1)} == DRIVE_COMMANDS
