"""Fields as texts: units, enums, bitmasks, texts from the link."""

from __future__ import annotations

import math

import pytest

from dialects import codec
from dialects import messages as m
from dialects.messages import MESSAGES
from groundstation.station.messages.message_fields import build_fields
from groundstation.views.messages import MessageField


def field(message: m.Message, name: str) -> MessageField:
    return next(each for each in build_fields(message) if each.name == name)


def sys_status(*, health: int) -> m.SysStatus:
    return m.SysStatus(0x1010021, 0x1010001, health, 412, 12104, 186, 76, 0, 3, 0, 0, 0, 0)


def test_a_value_is_also_given_in_a_usual_unit() -> None:
    message = sys_status(health=0x1010021)
    assert field(message, "voltage_battery") == MessageField("voltage_battery", "12104", "mV", "12.104 V")
    assert field(message, "load").meaning == "41.2 %"
    assert field(message, "errors_comm") == MessageField("errors_comm", "3", "")
    assert field(m.Attitude(0, math.pi, 0.0, 0.0, 0.0, 0.0, 0.0), "roll").meaning == "180.00 deg"


def test_an_enum_has_its_name_and_an_unknown_value_is_called_so() -> None:
    beat = m.Heartbeat(10, 3, 0x81, 0, 4, 3)
    assert field(beat, "type").meaning == "GROUND_ROVER"
    assert field(beat, "system_status") == MessageField("system_status", "4", "", "ACTIVE")
    assert field(m.Heartbeat(200, 3, 0, 0, 4, 3), "type").meaning == "not in MAV_TYPE"


def test_a_bitmask_is_given_as_flags() -> None:
    found = field(m.Heartbeat(10, 3, 0x81, 0, 4, 3), "base_mode")
    assert (found.value, found.meaning) == ("0x81", "2 flags")
    assert found.flags == ("CUSTOM_MODE_ENABLED", "SAFETY_ARMED")


def test_sensor_health_names_the_bad_and_the_disabled() -> None:
    found = field(sys_status(health=0x1000021), "onboard_control_sensors_health")
    assert found.meaning == "1 of 3 enabled not healthy"
    assert found.flags == ("✓✓✗ RC_RECEIVER", "✓✓✓ 3D_GYRO", "✓✓✓ LOGGING", "✓·· GPS")
    assert field(sys_status(health=0x1010001), "onboard_control_sensors_health").meaning == "all enabled healthy"


def test_texts_from_the_link_have_no_control_characters() -> None:
    text = field(m.StatusText(4, b"\x1b[2Jboo\x07", 0, 0), "text").value
    assert text.isprintable()
    assert "boo" in text
    name = field(m.ParamValue(b"A\x1bB", 1.0, 9, 1, 0), "param_id").value
    assert name.isprintable()


@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf])
def test_numbers_that_are_none_do_not_raise(value: float) -> None:
    assert field(m.Attitude(0, value, 0.0, 0.0, 0.0, 0.0, 0.0), "roll").meaning == ""


@pytest.mark.parametrize("pattern", [0x00, 0xFF, 0x1B, 0x80])
def test_every_message_with_any_bytes_gives_printable_fields(pattern: int) -> None:
    for number, kind in MESSAGES.items():
        fields = build_fields(codec.decode(number, bytes([pattern]) * 255))
        assert [each.name for each in fields] == kind.fieldnames
        for each in fields:
            assert all(text.isprintable() for text in (each.value, each.unit, each.meaning, *each.flags)), kind.msgname
            assert len(each.value) <= 200
