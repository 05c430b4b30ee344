"""Advice for the reasons against arming: known ones, and unknown ones that stand as they are."""

from __future__ import annotations

import inspect
import re

import pytest

from groundstation.doctor.prearm_advice import ADVICE, find_advice, reason_of
from vehicle.safety import arming


@pytest.mark.parametrize(("text", "reason"), [
    ("PreArm: Compass not calibrated", "Compass not calibrated"),
    ("Arm: Throttle (RC3) is not neutral", "Throttle (RC3) is not neutral"),
    ("Preflight Fail: No manual control input", "No manual control input"),
    ("EKF3 IMU0 is using GPS", None),
])  # fmt: skip
def test_reasons(text: str, reason: str | None) -> None:
    assert reason_of(text) == reason


@pytest.mark.parametrize(("reason", "words"), [
    ("Compass not calibrated", "calibrate the compass"),
    ("Compass calibrated requires reboot", "restart"),
    ("Compasses inconsistent", "metal"),
    ("3D Accel calibration needed", "accelerometers"),
    ("Accels inconsistent", "accelerometers"),
    ("Gyros not calibrated", "gyros"),
    ("Need Position Estimate", "position"),
    ("GPS 1: Bad fix", "position"),
    ("AHRS: not using configured AHRS type", "estimator"),
    ("Throttle (RC3) is not neutral", "centre the throttle"),
    ("throttle not in safe position", "let the keys go"),
    ("RC not found", "transmitter"),
    ("Radio failsafe on", "transmitter"),
    ("Battery 1 low voltage failsafe", "charge"),
    ("Hardware safety switch", "safety switch"),
    ("Hardware safety switch", "estop --clear"),
    ("Logging failed", "card"),
    ("No manual control input", "arm from Drive"),
    ("battery low", "charge"),
    ("emergency stop, release it first", "release"),
    ("throttle or steering not neutral", "release the sticks"),
    ("terminated, restart the vehicle", "restart"),
    ("BATT_CRT_VOLT is above BATT_LOW_VOLT", "BATT_CRT_VOLT"),
    ("Pi under-voltage", "power supply"),
])  # fmt: skip
def test_known_reasons(reason: str, words: str) -> None:
    assert words in find_advice(reason)


def test_an_unknown_reason_stands_as_it_is() -> None:
    assert find_advice("flux capacitor empty") == ""


def test_all_texts_of_our_rover_have_advice() -> None:
    found = re.findall(r'return f?"([^"]+)"', inspect.getsource(arming))
    assert len(found) > 8
    assert [
        text for text in found if text != "{damage}, using defaults; set one to continue" and not find_advice(text)
    ] == []


def test_a_general_row_hides_no_special_one() -> None:
    for index, each in enumerate(ADVICE):
        sample = " ".join(each.words)
        first = next(at for at, other in enumerate(ADVICE) if all(word in sample for word in other.words))
        assert first == index or ADVICE[first].text == each.text, each
