"""The dialect agrees with every other MAVLink program: CRC_EXTRA of each standard message that we define ourselves."""

from __future__ import annotations

import pytest
from pymavlink.dialects.v20 import common

from dialects import rover
from dialects.messages import MESSAGES

OFFICIAL = {
    "COMMAND_CANCEL": (80, 14),
    "ESC_INFO": (290, 251),
    "ESC_STATUS": (291, 10),
    "PROTOCOL_VERSION": (300, 217),
    "COMPONENT_METADATA": (397, 182),
    "AVAILABLE_MODES": (435, 134),
    "CURRENT_MODE": (436, 193),
    "AVAILABLE_MODES_MONITOR": (437, 30),
    "CONTROL_STATUS": (512, 21),
}

PRIVATE = {
    "ROVER_OPERATOR_PRESENCE": (46000, 244, 21),
    "ROVER_DRIVE_STATUS": (46001, 22, 22),
    "ROVER_FAILSAFE_STATUS": (46002, 108, 16),
    "ROVER_LINK_STATUS": (46003, 245, 38),
    "ROVER_DRIVE_INFO": (46004, 33, 24),
}


@pytest.mark.parametrize(("name", "number", "crc_extra"), [(name, *rest) for name, rest in OFFICIAL.items()])
def test_standard_messages_have_the_official_crc_extra(name: str, number: int, crc_extra: int) -> None:
    assert (MESSAGES[number].msgname, MESSAGES[number].crc_extra) == (name, crc_extra)


@pytest.mark.parametrize(("name", "number", "crc_extra", "size"), [(name, *rest) for name, rest in PRIVATE.items()])
def test_private_messages_never_change(name: str, number: int, crc_extra: int, size: int) -> None:
    # A changed CRC_EXTRA cuts off every vehicle in the field: new fields go in as extensions only.
    message = MESSAGES[number]
    assert (message.msgname, message.crc_extra, message.unpacker.size) == (name, crc_extra, size)


def test_common_is_the_installed_pymavlinks() -> None:
    for number, theirs in common.mavlink_map.items():
        assert MESSAGES[number].crc_extra == theirs.crc_extra, theirs.msgname
        assert MESSAGES[number].ordered_fieldnames == theirs.ordered_fieldnames, theirs.msgname


def test_request_operator_control_has_its_number() -> None:
    assert rover.MAV_CMD_REQUEST_OPERATOR_CONTROL == 32100
