"""The gamepad's core: dead zone, expo, dead-man button, and which frames are due."""

from __future__ import annotations

import math

import pytest

from groundstation.input.pad import HELD_PERIOD, IDLE_PERIOD, PadCore, PadFrame, PadReading, shape
from groundstation.input.pad_mapping import PadMapping

RB = "rightshoulder"
STEP = 0.01


class Reader:
    """A core that gets a reading each 10 ms."""

    def __init__(self, **mapping: object) -> None:
        self.core = PadCore(PadMapping(**mapping))  # type: ignore[arg-type]
        self.now = 0.0
        self.device = 1
        self.frames: list[PadFrame] = []
        self.read(0.05)

    def read(self, seconds: float, *buttons: str, **axes: float) -> PadFrame:
        """Read the same for so long; return the newest frame."""
        for _ in range(max(1, round(seconds / STEP))):
            self.now += STEP
            reading = PadReading(self.device, axes, frozenset(buttons))
            if (frame := self.core.update(("Pad",), 0, reading, self.now)) is not None:
                self.frames.append(frame)
        return self.frames[-1]


@pytest.mark.parametrize(
    ("value", "demand"),
    [
        (0.0, 0.0),
        (0.1, 0.0),
        (-0.1, 0.0),
        (1.0, 1.0),
        (-1.0, -1.0),
        (1.5, 1.0),
        (0.55, 0.5),
        (math.nan, 0.0),
        (math.inf, 0.0),
    ],
)
def test_a_stick_without_expo_is_linear_beyond_the_dead_zone(value: float, demand: float) -> None:
    assert shape(value, 0.1, 0.0) == pytest.approx(demand)


def test_expo_makes_small_movements_finer_and_keeps_the_ends() -> None:
    assert shape(0.5, 0.0, 1.0) == pytest.approx(0.125)
    assert shape(-0.5, 0.0, 0.4) == pytest.approx(-(0.6 * 0.5 + 0.4 * 0.125))
    assert shape(1.0, 0.0, 1.0) == 1.0
    assert shape(0.1001, 0.1, 0.0) < 0.001, "no step at the edge of the dead zone"


def test_without_the_dead_man_button_it_is_neutral() -> None:
    pad = Reader()
    frame = pad.read(0.2, lefty=1.0, rightx=-1.0)
    assert (frame.held, frame.throttle, frame.steering) == (False, 0.0, 0.0)
    pad.read(0.1, RB)
    frame = pad.read(0.1, RB, lefty=1.0, rightx=-1.0)
    assert (frame.held, frame.throttle, frame.steering) == (True, 1.0, -1.0)
    assert pad.read(STEP, lefty=1.0, rightx=-1.0).throttle == 0.0, "at once"


def test_sticks_held_when_the_button_goes_down_must_be_centred() -> None:
    pad = Reader()
    frame = pad.read(0.2, RB, lefty=1.0)
    assert frame.held
    assert frame.uncentred
    assert frame.throttle == 0.0
    pad.read(STEP, RB)
    assert pad.read(STEP, RB, lefty=1.0).throttle == 1.0


def test_button_down_when_its_gamepad_is_chosen_must_be_released() -> None:
    pad = Reader()
    pad.read(0.1, RB)
    assert pad.read(0.1, RB, lefty=1.0).throttle == 1.0
    pad.device = 2
    assert not pad.read(1.0, RB, lefty=1.0).held
    assert not pad.read(STEP).held
    assert pad.read(STEP, RB).held


def test_frames_come_at_once_after_change_and_else_at_their_rate() -> None:
    pad = Reader()
    pad.frames.clear()
    pad.read(2.0)
    assert len(pad.frames) == pytest.approx(2.0 / IDLE_PERIOD, abs=1)
    pad.read(STEP, RB)
    pad.frames.clear()
    pad.read(1.0, RB)
    assert len(pad.frames) == pytest.approx(1.0 / HELD_PERIOD, abs=1)
    begun = pad.now
    assert pad.read(STEP, RB, lefty=1.0).read_at == pytest.approx(begun + STEP)


def test_a_stick_that_moves_all_the_time_does_not_flood_the_link() -> None:
    pad = Reader()
    pad.read(0.1, RB)
    pad.frames.clear()
    for step in range(100):
        pad.read(STEP, RB, lefty=0.3 + step * 0.005)
    assert len(pad.frames) <= 1.0 / HELD_PERIOD + 2


def test_axes_can_be_others_and_reversed() -> None:
    pad = Reader(throttle="triggers", steering="-leftx", deadman="leftshoulder")
    pad.read(0.1, "leftshoulder")
    frame = pad.read(0.1, "leftshoulder", righttrigger=0.0, lefttrigger=1.0, leftx=1.0)
    assert (frame.throttle, frame.steering) == (-1.0, -1.0)


def test_an_unplugged_gamepad_is_neutral_at_once() -> None:
    pad = Reader()
    pad.read(0.1, RB)
    pad.read(0.1, RB, lefty=1.0)
    frame = pad.core.update((), 0, None, pad.now + STEP)
    assert frame is not None
    assert (frame.name, frame.held, frame.throttle) == ("", False, 0.0)


def test_the_first_frame_comes_at_once() -> None:
    assert PadFrame(0.0).chosen == 0
    frame = PadCore(PadMapping()).update((), 0, None, 0.0)
    assert frame == PadFrame(0.0, (), 0, held=False, uncentred=False, throttle=0.0, steering=0.0, buttons=())


def test_a_frame_is_at_most_5_ms_early() -> None:
    core = PadCore(PadMapping())
    core.update((), 0, None, 0.0)
    assert core.update((), 0, None, 0.494) is None
    assert core.update((), 0, None, 0.5 - 0.005) is not None


def test_a_button_with_an_action_is_told_at_the_rate_of_driving() -> None:
    pad = Reader(buttons={"b": "drive.stop", "a": "vehicle.hold"})
    assert pad.read(0.1, "b", "a", "x").buttons == ("a", "b")
    pad.frames.clear()
    pad.read(1.0, "b", "a", "x")
    assert len(pad.frames) == pytest.approx(20, abs=1)


def test_it_is_uncentred_only_while_the_button_is_down() -> None:
    pad = Reader()
    assert not pad.read(0.1, rightx=1.0).uncentred
    frame = pad.read(0.1, RB, rightx=1.0)
    assert (frame.uncentred, frame.steering) == (True, 0.0)
    assert not pad.read(STEP, RB).uncentred
    assert not pad.read(0.1, RB, rightx=1.0).uncentred


def test_a_stick_that_begins_to_steer_is_told_at_once() -> None:
    pad = Reader()
    pad.read(0.1, RB)
    while pad.read(STEP, RB).read_at != pad.now:
        pass
    assert pad.read(STEP, RB, rightx=1.0).read_at == pad.now, "the next one is not due yet"


def test_demands_have_two_digits() -> None:
    pad = Reader(dead_zone=0.0, expo=0.0)
    pad.read(0.1, RB)
    assert pad.read(0.1, RB, lefty=0.12345).throttle == 0.12
    assert pad.read(0.1, RB, lefty=0.126).throttle == 0.13
