"""Names of enum values, beside pymavlink's own tables."""

from __future__ import annotations

import pytest
from pymavlink.dialects.v20 import common

from dialects.enum_names import enum_names, flag_names


@pytest.mark.parametrize(
    "enum", ["MAV_TYPE", "MAV_STATE", "MAV_SYS_STATUS_SENSOR", "GPS_FIX_TYPE", "MAV_CMD", "MAV_COMPONENT"]
)
def test_every_value_of_the_official_definition_has_its_name(enum: str) -> None:
    names = enum_names(enum)
    for value, entry in common.enums[enum].items():
        if not entry.name.endswith("ENUM_END"):
            assert entry.name.endswith(names[value]), value


def test_values_that_pymavlink_lacks_have_names() -> None:
    assert [enum_names("MAV_RESULT")[number] for number in (6, 9, 10)] == [
        "CANCELLED", "COMMAND_UNSUPPORTED_MAV_FRAME", "NOT_IN_CONTROL",
    ]  # fmt: skip


def test_the_part_shared_with_the_enum_is_left_out() -> None:
    assert enum_names("MAV_TYPE")[6] == "GCS"
    assert enum_names("GPS_FIX_TYPE")[3] == "3D_FIX"
    assert enum_names("MAV_SYS_STATUS_SENSOR")[1 << 24] == "LOGGING"
    assert enum_names("ROVER_FAILSAFE")


def test_an_enum_that_is_not_known_has_no_names() -> None:
    assert enum_names("NO_SUCH_ENUM") == {}


def test_flags_are_the_bits_that_are_set() -> None:
    assert flag_names("MAV_MODE_FLAG", 0x81) == ("CUSTOM_MODE_ENABLED", "SAFETY_ARMED")
    assert flag_names("MAV_SYS_STATUS_SENSOR_EXTENDED", 1 << 30 | 1) == ("RECOVERY_SYSTEM", "0x40000000")
    assert flag_names("MAV_MODE_FLAG", 0) == ()
