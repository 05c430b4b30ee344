"""The table of MAV_TYPEs that are not a vehicle."""

from __future__ import annotations

from dialects.enums import type_name
from dialects.kinds import NO_VEHICLES


def test_each_mav_type_of_the_dialect_is_judged() -> None:
    parts = {
        "gcs", "onboard controller", "gimbal", "adsb", "camera", "charging station", "flarm", "servo", "odid",
        "battery", "parachute", "log", "osd", "imu", "gps", "winch", "illuminator", "gripper", "type 49",
    }  # fmt: skip
    assert {type_name(number) for number in NO_VEHICLES} == parts
