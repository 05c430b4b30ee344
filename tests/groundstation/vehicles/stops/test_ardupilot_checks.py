"""Settings of an ArduPilot rover that would let it drive on."""

from __future__ import annotations

import pytest

from tests.groundstation.vehicles.stops.test_settings_check import new_check, value

ALERT_WIDTH = 76
"""Columns of the alert line at 80 columns."""


@pytest.mark.parametrize(
    ("name", "good", "bad", "words"),
    [
        ("RC_OVERRIDE_TIME", 0.5, 3.0, "drives on for 3 s when the link is lost; set it to 0.5"),
        ("RC_OVERRIDE_TIME", 1.0, -1.0, "never stops when the link is lost; set it to 0.5"),
        ("FS_GCS_ENABLE", 1.0, 0.0, "no failsafe when the ground station is lost; set it to 1"),
        ("FS_THR_ENABLE", 1.0, 0.0, "without RC, never stops when the link is lost; set it to 1"),
        ("MAV_GCS_SYSID", 255.0, 252.0, "obeys ground station 252 only and we are 255: use --system 252"),
        ("SYSID_MYGCS", 511.0, 1.0, "obeys ground station 1 only and we are 255: use --system 1"),
    ],
)
def test_each_setting(name: str, good: float, bad: float, words: str) -> None:
    check = new_check()
    assert check.receive(value(name, good), 0.0) == []
    assert not check.warnings
    (warning,) = check.receive(value(name, bad), 0.0)
    assert words in warning
    assert len(warning) <= ALERT_WIDTH
    assert (*check.warnings, *filter(None, [check.obeys])) == (warning,)
    assert check.receive(value(name, bad), 0.0) == [], "reported once"
    check.receive(value(name, good), 0.0)
    assert not check.warnings
    assert check.obeys is None


def test_obeying_another_ground_station_is_no_ordinary_setting() -> None:
    check = new_check()
    check.receive(value("RC_OVERRIDE_TIME", -1.0), 0.0)
    check.receive(value("MAV_GCS_SYSID", 250.0), 0.0)
    assert check.obeys == "obeys ground station 250 only and we are 255: use --system 250"
    assert check.warnings == ("RC_OVERRIDE_TIME -1: never stops when the link is lost; set it to 0.5",)


@pytest.mark.parametrize(
    ("override", "throttle", "words"),
    [
        (3.0, 1.0, "by its settings it drives on for 3 s"),
        (0.5, 2.0, "by its settings it drives on for 0.5 s"),
        (-1.0, 1.0, "by its settings it never stops"),
        (3.0, 0.0, "without an RC receiver it never stops"),
        (None, 1.0, None),
        (3.0, None, None),
    ],
)
def test_what_a_lost_link_means(override: float | None, throttle: float | None, words: str | None) -> None:
    check = new_check()
    for name, number in (("RC_OVERRIDE_TIME", override), ("FS_THR_ENABLE", throttle)):
        if number is not None:
            check.receive(value(name, number), 0.0)
    assert check.link_loss_action == words
