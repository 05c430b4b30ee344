"""Settings of an ArduPilot rover that would let it drive on."""

from __future__ import annotations

import math

import pytest

from dialects.messages import ParamRequestRead, ParamValue
from groundstation.vehicles.ardupilot_checks import PARAM_CHECKS, ArduPilotChecks
from link.core import Peer, Received


def new_check() -> ArduPilotChecks:
    return ArduPilotChecks(255, 190, target=(1, 1))


def value(name: str, number: float, system: int = 1) -> Received:
    message = ParamValue(name.encode(), number, 9, 1, 65535)
    return Received(message, system, 1, 0, Peer(0, "vehicle"), introduced=True)


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
    check = new_check()
    assert check.receive(value(name, good), 0.0) == []
    assert not check.warnings
    (warning,) = check.receive(value(name, bad), 0.0)
    assert words in warning
    assert check.warnings == (warning,)
    assert check.receive(value(name, bad), 0.0) == [], "reported once"
    check.receive(value(name, good), 0.0)
    assert not check.warnings


@pytest.mark.parametrize("number", [math.nan, math.inf])
def test_no_number_is_no_setting(number: float) -> None:
    check = new_check()
    assert check.receive(value("MAV_GCS_SYSID", number), 0.0) == []
    assert check.warnings == ()


def test_an_unanswered_read_is_repeated_three_times() -> None:
    check = new_check()
    asked: list[bytes] = []
    check.receive(value("FS_GCS_ENABLE", 1.0), 0.0)
    for second in range(20):
        for outgoing in check.tick(second * 0.5):
            assert isinstance(outgoing.message, ParamRequestRead)
            asked.append(outgoing.message._param_id_raw)
    assert len(asked) == 3 * (len(PARAM_CHECKS) - 1)
    assert "FS_GCS_ENABLE" not in [name.decode() for name in asked]


def test_only_the_checked_parameters_of_this_vehicle_count() -> None:
    check = new_check()
    assert check.receive(value("FS_GCS_ENABLE", 0.0, system=2), 0.0) == []
    for number in range(1000):
        assert check.receive(value(f"OTHER_{number}", 0.0), 0.0) == []
    assert check.warnings == ()
    assert check._params.params == {}, "a flood of names must not grow a table"
