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


def test_before_any_reading_nothing_drives() -> None:
    stick = PadStick()
    assert not stick.held(0.0)
    assert stick.axes == Axes(0.0, 0.0)


def test_at_the_end_of_its_time_a_reading_no_longer_counts() -> None:
    stick = PadStick()
    assert stick.push(DrivePad(1.0, 0.0, 100.0), 100.0)
    assert stick.until == 100.25
    assert not stick.held(100.25)
    for read_at in (99.75, 99.0):
        assert not stick.push(DrivePad(1.0, 0.0, read_at), 100.0)
        assert not stick.held(100.0)


@pytest.mark.parametrize(("throttle", "steering"), [(math.nan, 0.0), (0.0, math.inf), (math.nan, math.nan)])
def test_what_is_no_number_ends_the_drive(throttle: float, steering: float) -> None:
    stick = PadStick()
    assert stick.push(DrivePad(1.0, 0.0, 100.0), 100.0)
    assert not stick.push(DrivePad(throttle, steering, 100.1, repeat=True), 100.1)
    assert not stick.held(100.1)


def test_axes_are_at_most_full() -> None:
    stick = PadStick()
    stick.push(DrivePad(1.25, -1.25, 100.0), 100.0)
    assert stick.axes == Axes(1.0, -1.0)
