"""Plan rules: what an upload rejects, and the reason in a STATUSTEXT."""

from __future__ import annotations

import math

import pytest

from dialects import messages as m
from dialects.enums import Command, MissionResult, MissionType, Result
from tests.rows import each_row
from tests.vehicle.bench import said
from tests.vehicle.field import Field
from tests.vehicle.missions import Item, do, ready, upload, way

NAN = math.nan
NAV_TAKEOFF = 22


@each_row(
    ("item", "verdict"),
    [
        (do(NAV_TAKEOFF), MissionResult.UNSUPPORTED),
        (do(Command.DO_SET_SERVO, 1, 1500), MissionResult.INVALID_PARAM1),  # a motor
        (do(Command.DO_SET_SERVO, 5.5, 1500), MissionResult.INVALID_PARAM1),
        (do(Command.DO_SET_SERVO, 17, 1500), MissionResult.INVALID_PARAM1),
        (do(Command.DO_SET_SERVO, NAN, 1500), MissionResult.INVALID_PARAM1),
        (do(Command.DO_SET_SERVO, 5, 1e6), MissionResult.INVALID_PARAM2),
        (do(Command.DO_SET_RELAY, 0, 2), MissionResult.INVALID_PARAM2),
        (do(Command.DO_SET_RELAY, -1, 1), MissionResult.INVALID_PARAM1),
        (do(Command.DO_SET_RELAY, 0.5, 1), MissionResult.INVALID_PARAM1),
        (do(Command.DO_REPEAT_SERVO, 3, 1500, 2, 1), MissionResult.INVALID_PARAM1),  # a motor
        (do(Command.DO_REPEAT_SERVO, 9, 1500, 0, 1), MissionResult.INVALID_PARAM3),
        (do(Command.DO_REPEAT_SERVO, 9, 1500, 2, -1), MissionResult.INVALID_PARAM4),
        (do(Command.DO_REPEAT_RELAY, 16, 2, 1), MissionResult.INVALID_PARAM1),
        (do(Command.DO_REPEAT_RELAY, 0, NAN, 1), MissionResult.INVALID_PARAM2),
        (do(Command.DO_REPEAT_RELAY, 0, 2, NAN), MissionResult.INVALID_PARAM3),
        (do(Command.DO_JUMP, 7, 1), MissionResult.INVALID_PARAM1),
        (do(Command.NAV_DELAY, -1), MissionResult.INVALID_PARAM1),
        (do(Command.DO_CHANGE_SPEED, 1, NAN), MissionResult.INVALID_PARAM2),
        ((Command.NAV_WAYPOINT, None, ()), MissionResult.UNSUPPORTED_FRAME),
    ],
)
def test_unsupported_items_are_rejected_at_the_upload(item: Item, verdict: MissionResult) -> None:
    field = ready(way(5, 0))
    assert upload(field, way(1, 1), item) == verdict
    field.say(m.MissionRequestList(1, 1, MissionType.MISSION))
    assert field.newest(m.MissionCount).count == 1  # the old one stays


@pytest.mark.parametrize(
    ("item", "why"),
    [
        (do(NAV_TAKEOFF), "item 1, command 22 not offered"),
        ((Command.NAV_WAYPOINT, None, ()), "item 1, frame 2 not offered"),
        (do(Command.NAV_DELAY, -1), "item 1, invalid param1"),
        (do(Command.DO_JUMP, 7, 1), "its items do not fit together"),
    ],
)
def test_the_rejected_item_is_reported(item: Item, why: str) -> None:
    field = Field()
    field.heartbeat()
    upload(field, way(1, 1), item)
    field.wait(0.1)
    assert said(field, f"Mission refused: {why}")


@pytest.mark.parametrize(
    ("params", "result"), [((1, 1500), Result.DENIED), ((5, 1500), Result.DENIED), ((NAN, 1500), Result.DENIED)]
)
def test_do_set_servo_for_a_motor_is_denied(params: tuple[float, ...], result: Result) -> None:
    assert Field().command(Command.DO_SET_SERVO, *params) is result
