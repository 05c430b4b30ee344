"""The dead man of the gamepad, in numbers: 0.25 s after its newest reading nothing drives."""

from __future__ import annotations

import math

import pytest

from dialects.axes import Axes
from groundstation.input.pad_stick import PadStick
from groundstation.intents.driving import DrivePad


def held_at(now: float, push: DrivePad, arrives: float = 100.0) -> bool:
    stick = PadStick()
    stick.push(push, arrives)
    return stick.held(now)


@pytest.mark.parametrize(("now", "held"), [(100.0, True), (100.24, True), (100.26, False), (102.0, False)])
def test_a_reading_drives_for_a_quarter_of_a_second(now: float, held: bool) -> None:
    assert held_at(now, DrivePad(1.0, 0.0, 100.0)) is held


@pytest.mark.parametrize("ahead", [0.1, 1.0, 3600.0, math.inf])
def test_a_reading_of_the_future_drives_no_longer(ahead: float) -> None:
    push = DrivePad(1.0, 0.0, 100.0 + ahead)
    assert held_at(100.24, push)
    assert not held_at(100.26, push)


def test_a_late_reading_drives_for_what_is_left_of_it() -> None:
    push = DrivePad(1.0, 0.0, 99.9)
    assert held_at(100.14, push)
    assert not held_at(100.16, push)
    assert not held_at(100.0, DrivePad(1.0, 0.0, 99.74))


def test_after_a_pause_the_button_must_be_pressed_again() -> None:
    stick = PadStick()
    assert stick.push(DrivePad(1.0, 0.0, 100.0), 100.0)
    assert stick.push(DrivePad(1.0, 0.0, 100.24, repeat=True), 100.24)
    assert not stick.push(DrivePad(1.0, 0.0, 100.5, repeat=True), 100.5)
    assert not stick.held(100.5)
    assert stick.push(DrivePad(0.5, -2.0, 100.6), 100.6)
    assert stick.axes == Axes(0.5, -1.0)
