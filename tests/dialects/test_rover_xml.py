"""The dialect agrees with every other MAVLink program: CRC_EXTRA of each standard message that we define ourselves."""

from __future__ import annotations

import pytest
from pymavlink.dialects.v20 import common

from dialects import codec, rover
from dialects.messages import MESSAGES, Message
from tests.rows import each_row

OFFICIAL = {
    "COMMAND_CANCEL": (80, 14),
    "MAG_CAL_PROGRESS": (191, 92),
    "EKF_STATUS_REPORT": (193, 71),
    "ESC_INFO": (290, 251),
    "ESC_STATUS": (291, 10),
    "PROTOCOL_VERSION": (300, 217),
    "COMPONENT_METADATA": (397, 182),
    "AVAILABLE_MODES": (435, 134),
    "CURRENT_MODE": (436, 193),
    "AVAILABLE_MODES_MONITOR": (437, 30),
    "CONTROL_STATUS": (512, 21),
}

EXTENDED = {
    "MISSION_CURRENT": (42, 28, 18, ("mission_id", "fence_id", "rally_points_id")),
    "MISSION_COUNT": (44, 221, 9, ("opaque_id",)),
    "MISSION_ACK": (47, 153, 8, ("opaque_id",)),
    "SET_ATTITUDE_TARGET": (82, 49, 51, ("thrust_body",)),
    "TIMESYNC": (111, 34, 18, ("target_system", "target_component")),
}
"""Messages with fields of additions.xml: id, CRC_EXTRA, whole payload size, the fields, last in the payload."""

PRIVATE = {
    "ROVER_OPERATOR_PRESENCE": (46000, 244, 29),  # 21 without its extensions x, y, z, r
    "ROVER_DRIVE_STATUS": (46001, 22, 24),  # 22 without its extension speed_limit
    "ROVER_FAILSAFE_STATUS": (46002, 108, 16),
    "ROVER_LINK_STATUS": (46003, 245, 38),
    "ROVER_DRIVE_INFO": (46004, 33, 24),
    "ROVER_CONTROL": (46005, 79, 7),
    "ROVER_STATION_EVENT": (46006, 232, 107),
}


@each_row(("name", "number", "crc_extra"), [(name, *rest) for name, rest in OFFICIAL.items()])
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
        added = list(EXTENDED[theirs.msgname][3]) if theirs.msgname in EXTENDED else []
        assert MESSAGES[number].ordered_fieldnames == theirs.ordered_fieldnames + added, theirs.msgname


@pytest.mark.parametrize(
    ("name", "number", "crc_extra", "size", "fields"), [(name, *rest) for name, rest in EXTENDED.items()]
)
def test_added_fields_are_extensions_with_the_official_crc_extra(
    name: str, number: int, crc_extra: int, size: int, fields: tuple[str, ...]
) -> None:
    message = MESSAGES[number]
    assert (message.msgname, message.crc_extra, message.unpacker.size) == (name, crc_extra, size)
    assert message.ordered_fieldnames[-len(fields) :] == list(fields)


@pytest.mark.parametrize("number", [each[0] for each in EXTENDED.values()])
def test_programs_without_added_fields_are_understood_both_ways(number: int) -> None:
    theirs = common.mavlink_map[number]
    payload = bytes(range(1, theirs.unpacker.size + 1))
    message = codec.decode(number, payload)
    assert all(not any(_values(message, field)) for field in EXTENDED[message.msgname][3])
    assert codec.encode_payload(message) == payload  # the added fields are zeros, and cut
    whole = codec.frame(number, bytes(range(1, MESSAGES[number].unpacker.size + 1)), 0, 1, 1)
    read = common.MAVLink(None).parse_buffer(whole)
    assert [each.get_type() for each in read or ()] == [theirs.msgname]


def _values(message: Message, field: str) -> list[float]:
    value = getattr(message, field)
    return value if isinstance(value, list) else [value]


def test_request_operator_control_has_its_number() -> None:
    assert rover.MAV_CMD_REQUEST_OPERATOR_CONTROL == 32100
