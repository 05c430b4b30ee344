"""Mixers: rounding at full, and what is reported as cut."""

from __future__ import annotations

import pytest

from dialects.enums import DriveType
from vehicle.drive.mixer import MIXERS, MixerLimits, MixerOutput, clamp, four_wheels, skid


def test_limits_cut_alike_and_allow_equal_reverse_by_default() -> None:
    assert MixerLimits() == (0.5, 1.0)
    assert not MixerOutput((0.0,)).saturated


def test_a_sum_beyond_full_is_reported_as_cut() -> None:
    assert four_wheels(1.0, 0.0, 0.0, MixerLimits()) == MixerOutput((1.0,) * 4, saturated=False)
    assert four_wheels(1.0, 0.25, 0.0, MixerLimits()) == MixerOutput((1.0, 0.6, 1.0, 0.6), saturated=True)
    assert four_wheels(0.25, 0.25, 0.75, MixerLimits()).saturated
    assert skid(1.0, 0.001, 0.0, MixerLimits()).saturated
    assert not skid(1.0, 0.0, 0.0, MixerLimits()).saturated
    assert not skid(0.5, 0.5, 0.0, MixerLimits()).saturated


def test_sums_that_round_beyond_full_are_full() -> None:
    assert skid(0.68, -0.95, 0.0, MixerLimits(1.0, 1.2)).throttles == (-1.0, 1.0)


@pytest.mark.parametrize(("value", "found"), [(0.5, 0.5), (0.6, 0.5), (-0.5, -0.5), (-0.6, -0.5), (0.1, 0.1)])
def test_clamp(value: float, found: float) -> None:
    assert clamp(value, 0.5) == found


def test_wiring_and_abilities_of_each_drive() -> None:
    """ArduRover's default servo outputs, in the order of the motors."""
    assert {
        kind: (mixer.motors, mixer.servos, mixer.sideways, mixer.driven_count) for kind, mixer in MIXERS.items()
    } == {
        DriveType.SKID: (("left", "right"), (1, 3), False, 2),
        DriveType.ACKERMANN: (("throttle", "steering"), (3, 1), False, 1),
        DriveType.OMNI: (("front left", "front right", "rear left", "rear right"), (4, 1, 3, 2), True, 4),
        DriveType.MECANUM: (("front left", "front right", "rear left", "rear right"), (4, 1, 3, 2), True, 4),
    }
