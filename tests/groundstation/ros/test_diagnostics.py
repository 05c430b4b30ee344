"""The state of a vehicle as diagnostics, and its texts as lines of /rosout."""

from __future__ import annotations

from typing import Any

import pytest

from groundstation.ros.diagnostics import ERROR, OK, STALE, WARN, diagnostics, log_line
from groundstation.ros.types import RosTypes
from groundstation.snapshot import VehicleView


def view(**fields: Any) -> VehicleView:
    usual = {"system": 1, "name": "Rover 1", "autopilot": 0, "mode": "MANUAL", "armed": True, "status": 4}
    return VehicleView(**usual | {"alive": True, "silence": 0.2} | fields)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("fields", "level", "message"),
    [
        ({}, OK, "armed, MANUAL"),
        ({"armed": False, "mode": "HOLD"}, OK, "disarmed, HOLD"),
        ({"armed": False, "prearm": False, "prearm_reason": "PreArm: no GPS"}, WARN, "PreArm: no GPS"),
        ({"failsafes": ("GCS",)}, ERROR, "failsafe: GCS"),
        ({"alive": False, "silence": 4.0, "failsafes": ("GCS",)}, STALE, "not heard for 4 s"),
    ],
)
def test_the_worst_is_said(fields: dict[str, Any], level: int, message: str) -> None:
    types, kind = RosTypes(), "diagnostic_msgs/msg/DiagnosticArray"
    made = types.decode(kind, types.encode(kind, diagnostics(view(**fields), True, 1_000_000)))
    status = made.status[0]
    assert (status.level, status.message, status.hardware_id) == (level, message, "1")
    assert {each.key: each.value for each in status.values}["driven from ROS"] == "True"


@pytest.mark.parametrize(("severity", "level"), [(0, 50), (2, 50), (3, 40), (4, 30), (6, 20), (7, 10), (200, 20)])
def test_texts_have_the_levels_of_ros(severity: int, level: int) -> None:
    types, kind = RosTypes(), "rcl_interfaces/msg/Log"
    made = types.decode(kind, types.encode(kind, log_line("Armed", severity, "mavhelm_1", 1_500_000)))
    assert (made.level, made.msg, made.name) == (level, "Armed", "mavhelm_1")
    assert (made.stamp.sec, made.stamp.nanosec) == (1, 500_000_000)
