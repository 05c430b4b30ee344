"""The thumb stick of a touch screen as a gamepad: its dead-man button, its age, and what is left of a late reading."""

from __future__ import annotations

from typing import get_args

import pytest

from groundstation.actions import ACTIONS
from groundstation.input.pad import PadFrame
from groundstation.input.pad_stick import PadStick
from groundstation.input.touch_stick import NAME, STOPS, TOUCH, TouchButton, TouchReading, TouchStick
from groundstation.intents.driving import PAD_WINDOW, DrivePad

SINCE = 100.0


class Page:
    """One page whose readings take `delay` s to come."""

    def __init__(self) -> None:
        self.stick = TouchStick(SINCE)
        self.now = SINCE + 10.0
        self.take(held=False)

    def take(
        self, *buttons: TouchButton, held: bool = True, x: float = 0.0, y: float = 0.0, delay: float = 0.0
    ) -> PadFrame | None:
        self.now += 0.1
        at = (self.now - delay - SINCE) * 1000.0
        return self.stick.take(TouchReading(max(0.0, at), held, x, y, buttons), self.now)


def test_a_touched_stick_drives_and_a_lifted_one_does_not() -> None:
    page = Page()
    first = page.take()
    assert first is not None
    assert (first.names, first.held, first.throttle, first.steering) == ((NAME,), True, 0.0, 0.0)
    pushed = page.take(x=0.5, y=1.0)
    assert pushed is not None
    assert (pushed.held, pushed.throttle) == (True, 1.0)
    assert 0.0 < pushed.steering < 0.5
    lifted = page.take(held=False)
    assert lifted is not None
    assert not lifted.held


def test_a_stick_that_is_pushed_from_the_start_does_not_drive() -> None:
    stick = TouchStick(SINCE)
    frame = stick.take(TouchReading(0.0, True, 0.0, 1.0, ()), SINCE)
    assert frame is None or (not frame.held and not frame.throttle)


def test_a_reading_has_the_time_at_which_it_was_made() -> None:
    page = Page()
    page.take()
    frame = page.take(y=1.0, delay=0.2)
    assert frame is not None
    assert frame.read_at == pytest.approx(page.now - 0.2)


def test_a_page_whose_clock_is_ahead_is_not_believed() -> None:
    page = Page()
    page.take()
    frame = page.take(y=1.0, delay=-5.0)
    assert frame is not None
    assert frame.read_at == page.now


def test_what_a_line_has_held_back_drives_nothing() -> None:
    """The station is neutral, and stays so until the stick was lifted."""
    page, sticks = Page(), PadStick()
    held = False
    for delay, drives in ((0.0, True), (0.1, True), (0.2, True), (0.35, False), (2.0, False), (0.0, False)):
        frame = page.take(y=1.0 if held else 0.0, delay=delay)
        if frame is not None:
            demand = DrivePad(frame.throttle, frame.steering, frame.read_at, repeat=held)
            assert sticks.push(demand, page.now) == drives, delay
            held = frame.held
        assert sticks.held(page.now) == drives, delay
    assert not sticks.held(page.now + PAD_WINDOW)


def test_of_late_buttons_only_those_that_stop_are_left() -> None:
    page = Page()
    late = page.take("start", "y", "b", "back", "x", held=False, delay=1.0)
    assert late is not None
    assert set(late.buttons) == STOPS
    soon = page.take("start", held=False)
    assert soon is not None
    assert soon.buttons == ("start",)


def test_each_button_has_an_action_and_those_that_stop_are_known() -> None:
    assert set(get_args(TouchButton)) == set(TOUCH.buttons)
    assert {TOUCH.buttons[name] for name in STOPS} == {"drive.stop", "stop.emergency", "vehicle.hold"}
    assert set(TOUCH.buttons.values()) <= set(ACTIONS)


def test_the_clock_of_a_page_begins_with_it() -> None:
    assert TouchStick(SINCE).clock(SINCE) == 0.0
    assert TouchStick(SINCE).clock(SINCE + 1.5) == 1500.0
