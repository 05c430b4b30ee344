"""Settings of an ArduPilot rover that would let it drive on."""

from __future__ import annotations

import math

import pytest

from dialects.messages import ParamRequestRead, ParamValue
from groundstation.vehicles.ardupilot_checks import PARAM_CHECKS, ArduPilotChecks


def value(name: str, number: float) -> ParamValue:
    return ParamValue(name.encode(), number, 9, 1, 65535)


@pytest.mark.parametrize(
    ("name", "good", "bad", "words"),
    [
        ("RC_OVERRIDE_TIME", 0.5, 3.0, "drives on for 3 s"),
        ("RC_OVERRIDE_TIME", 1.0, -1.0, "never stops"),
        ("FS_GCS_ENABLE", 1.0, 0.0, "no failsafe"),
        ("FS_THR_ENABLE", 1.0, 0.0, "never stops"),
        ("MAV_GCS_SYSID", 255.0, 252.0, "obeys ground station 252 only"),
        ("SYSID_MYGCS", 511.0, 1.0, "obeys ground station 1 only"),
    ],
)
def test_each_setting(name: str, good: float, bad: float, words: str) -> None:
    check = ArduPilotChecks(255, (1, 1))
    assert check.handle_param(value(name, good)) is None
    assert not check.warnings
    warning = check.handle_param(value(name, bad))
    assert warning is not None
    assert words in warning
    assert check.warnings == (warning,)
    assert check.handle_param(value(name, bad)) is None, "said once"
    check.handle_param(value(name, good))
    assert not check.warnings


@pytest.mark.parametrize("number", [math.nan, math.inf])
def test_no_number_is_no_setting(number: float) -> None:
    check = ArduPilotChecks(255, (1, 1))
    assert check.handle_param(value("MAV_GCS_SYSID", number)) is None


def test_silence_is_asked_again_three_times_and_then_left_alone() -> None:
    check = ArduPilotChecks(255, (1, 1))
    asked: list[bytes] = []
    check.handle_param(value("FS_GCS_ENABLE", 1.0))
    for second in range(20):
        for message in check.tick(second * 0.5):
            assert isinstance(message, ParamRequestRead)
            asked.append(message._param_id_raw)
    assert len(asked) == 3 * (len(PARAM_CHECKS) - 1)
    assert "FS_GCS_ENABLE" not in [name.decode() for name in asked]
