"""The health of a vehicle in words, out of messages that pymavlink has built."""

from __future__ import annotations

import math

import pytest
from pymavlink.dialects.v20 import ardupilotmega as mav

from groundstation.snapshot.drive import HealthLine
from groundstation.vehicles.health.health import HealthReadings
from link.protocol.channel import Channel

GYRO, COMPASS, GPS, RC = 1, 4, 32, 1 << 16
GOOD = 0x033F
"""Attitude, velocity, position."""


def health(*messages: mav.MAVLink_message, at: float = 10.0) -> dict[str, HealthLine]:
    """Return the lines after these messages, which arrived at 10 s, by name."""
    made = HealthReadings()
    channel = Channel("memory", 0, system=255, component=190)
    vehicle = mav.MAVLink(None, srcSystem=1, srcComponent=1)
    for message in messages:
        for received in channel.receive(message.pack(vehicle), "vehicle", 10.0):
            made.receive(received.message, 10.0)
        vehicle.seq = (vehicle.seq + 1) % 256
    return {line.name: line for line in made.build_lines(at)}


def sys_status(present: int, enabled: int, healthy: int) -> mav.MAVLink_message:
    return mav.MAVLink_sys_status_message(present, enabled, healthy, 300, 12100, 190, 76, 0, 0, 0, 0, 0, 0)


def test_present_enabled_and_healthy_are_one_word() -> None:
    lines = health(sys_status(GYRO | COMPASS | GPS, GYRO | COMPASS | RC, GYRO | GPS))
    found = {name: (line.text, line.good) for name, line in lines.items() if name != "battery"}
    assert found == {
        "gyro": ("ok", True), "compass": ("not healthy", False), "RC": ("missing", False), "gps": ("off", None),
    }  # fmt: skip
    assert [line.good for line in lines.values()] == [False, False, True, True, None], "what to look at comes first"


def test_a_fix_proves_a_receiver_that_px4_calls_missing() -> None:
    gps = mav.MAVLink_gps_raw_int_message(0, 3, 0, 0, 0, 80, 65535, 0, 0, 10)
    assert health(gps, sys_status(0, GPS, 0))["gps"] == HealthLine("gps", "3D, 10 satellites, hdop 0.8", True)
    lost = mav.MAVLink_gps_raw_int_message(0, 1, 0, 0, 0, 65535, 65535, 0, 0, 255)
    assert health(lost, sys_status(0, GPS, 0))["gps"].good is False


def test_a_sensor_that_is_not_healthy_keeps_its_reading() -> None:
    gps = mav.MAVLink_gps_raw_int_message(0, 3, 0, 0, 0, 80, 65535, 0, 0, 14)
    assert health(gps)["gps"] == HealthLine("gps", "3D, 14 satellites, hdop 0.8", True)
    line = health(gps, sys_status(GPS, GPS, 0))["gps"]
    assert (line.text, line.good) == ("not healthy, 3D, 14 satellites, hdop 0.8", False)


@pytest.mark.parametrize(
    ("flags", "variances", "text", "good"),
    [
        (GOOD, (0.1, 0.2, 0.0, 0.05), "good, worst variance 0.20", True),
        (GOOD, (0.1, 0.9, 0.0, 0.05), "position variance 0.90", False),
        (GOOD & ~2, (0.1, 0.1, 0.0, 0.1), "no velocity", False),
        (GOOD | 128, (0.1, 0.1, 0.0, 0.1), "no position", False),
        (1024, (0.0, 0.0, 0.0, 0.0), "not initialised", False),
        (GOOD, (math.nan, math.nan, math.nan, math.nan), "good", True),
    ],
)
def test_the_estimate_of_ardupilot(flags: int, variances: tuple[float, ...], text: str, good: bool) -> None:
    velocity, horizontal, vertical, compass = variances
    message = mav.MAVLink_ekf_status_report_message(flags, velocity, horizontal, vertical, compass, 0.0)
    line = health(message)["estimate"]
    assert (line.text, line.good) == (text, good)


def test_the_estimate_of_px4() -> None:
    def line(flags: int, ratio: float, accuracy: float) -> HealthLine:
        message = mav.MAVLink_estimator_status_message(0, flags, ratio, 0.1, 0.0, 0.1, 0.0, 0.0, accuracy, 0.5)
        return health(message)["estimate"]

    assert line(GOOD, 0.1, 0.4) == HealthLine("estimate", "good, within 0.4 m, worst ratio 0.10", True)
    assert line(GOOD | 1024, 0.7, 0.4) == HealthLine("estimate", "GPS glitch; velocity ratio 0.70", False)


def test_vibration_battery_and_old_news() -> None:
    assert health(mav.MAVLink_vibration_message(0, 1.0, 12.0, 3.0, 0, 0, 0))["vibration"].text == "12 m/s²"
    bad = health(mav.MAVLink_vibration_message(0, 1.0, 42.0, 3.0, 2, 1, 0))["vibration"]
    assert (bad.text, bad.good) == ("42 m/s², 3 clipped", False)
    empty = mav.MAVLink_battery_status_message(0, 0, 0, 0, [10400] + [65535] * 9, -1, -1, -1, 12)
    assert health(empty)["battery"] == HealthLine("battery", "10.4 V  12%", False)
    assert health(empty, at=40.0)["battery"] == HealthLine("battery", "10.4 V  12%, 30 s ago", None)


def test_what_the_vehicle_does_not_tell_has_no_line() -> None:
    nothing = mav.MAVLink_sys_status_message(0, 0, 0, 0, 65535, -1, -1, 0, 0, 0, 0, 0, 0)
    assert health(nothing) == {}
    assert health(mav.MAVLink_vibration_message(0, math.nan, math.nan, math.nan, 0, 0, 0)) == {}
