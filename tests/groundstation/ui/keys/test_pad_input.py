"""Frames of the gamepad on the screen's side: sticks for the station, buttons as keys behind the same gate."""

from __future__ import annotations

from collections.abc import Iterator

import pytest
from textual import events
from textual.message import Message

from groundstation.gamepad.child import GamepadChild
from groundstation.input.pad import PadFrame
from groundstation.input.pad_mapping import ANY, PadMapping, add_buttons
from groundstation.intents.driving import DrivePad, EmergencyStop, ReleasePad, StepLimits, Stop
from groundstation.intents.vehicle import Arm, SetMode
from groundstation.intents.vehicle_intent import HOLD_TIME
from groundstation.ui.keys.key_gate import OTHER_SCREEN, TEXT_FIELD, KeyGate
from groundstation.ui.keys.keynames import format_key
from groundstation.ui.keys.pad_input import PadInput
from groundstation.ui.keys.pad_state import PadState
from groundstation.ui.terminal.key_parser import KeyUp
from tests.groundstation.ui.examples import Recorder
from tests.groundstation.ui.ptys import STANDARD
from tests.groundstation.ui.sinks import Clock


class Pad:
    """A gamepad behind an open gate of a disarmed vehicle."""

    def __init__(self, station: Recorder) -> None:
        self.station, self.clock = station, Clock()
        self.gate = KeyGate(station, add_buttons(STANDARD, PadMapping()), self.clock)
        self.gate.set_closure(None)
        self.gate.update(armed=False, driving=False)
        self.posted: list[Message] = []
        self.input = PadInput(GamepadChild(PadMapping(), ANY), self.gate, station.send, self.posted.append)
        station.intents.clear()

    def take(self, *buttons: str, held: bool = False, throttle: float = 0.0) -> None:
        self.input.take(PadFrame(self.clock(), ("One",), held=held, throttle=throttle, buttons=buttons))


@pytest.fixture
def pad() -> Iterator[Pad]:
    recorder = Recorder()
    yield Pad(recorder)
    recorder.close()


def test_sticks_are_sent_while_the_button_is_held_and_once_after(pad: Pad) -> None:
    pad.take()
    pad.take(held=True, throttle=0.5)
    pad.take(held=True, throttle=0.5)
    pad.take()
    pad.take()
    at = pad.clock()
    assert pad.station.intents == [DrivePad(0.5, 0.0, at), DrivePad(0.5, 0.0, at, repeat=True), ReleasePad()]


def test_the_end_of_the_reader_is_a_release(pad: Pad) -> None:
    pad.take(held=True, throttle=0.5)
    pad.input.take(PadFrame(pad.clock()))
    assert pad.station.intents[-1] == ReleasePad()
    assert pad.input.state(pad.clock()).lost


def test_arming_needs_button_held_and_a_tap_of_another_acts_once(pad: Pad) -> None:
    for _ in range(10):
        pad.take("dpup")
    pad.take()
    pad.take("y")
    pad.take("y")
    pad.take()
    assert pad.station.of(StepLimits) == [StepLimits(throttle=0.1, steering=0.1)]
    pad.take("dpup")
    assert len(pad.station.of(StepLimits)) == 2
    pad.take()
    assert pad.station.of(SetMode) == [SetMode(mode="MANUAL")]
    for _ in range(int(HOLD_TIME / 0.05)):
        pad.take("start")
        pad.clock.now += 0.05
    assert not pad.station.of(Arm)
    pad.clock.now += 0.05
    pad.take("start")
    assert len(pad.station.of(Arm)) == 1
    for _ in range(20):
        pad.take("start")
        pad.clock.now += 0.05
    assert len(pad.station.of(Arm)) == 1


def test_on_other_screens_and_in_text_fields_only_stops_pass(pad: Pad) -> None:
    for closure in (OTHER_SCREEN, TEXT_FIELD):
        pad.gate.set_closure(closure)
        pad.station.intents.clear()
        for button in ("y", "dpup", "b", "back"):
            pad.take(button)
            pad.take()
        assert pad.station.intents == [Stop(), EmergencyStop(), Stop()]


def test_a_press_reaches_the_screen_on_top_as_a_key(pad: Pad) -> None:
    pad.take("rightstick")
    pad.take("rightstick")
    pad.take()
    press, release = pad.posted
    assert isinstance(press, events.Key)
    assert isinstance(release, KeyUp)
    assert (press.key, press.character, release.key) == ("pad_rightstick", None, "pad_rightstick")
    assert format_key("pad_rightstick") == "pad R3"


def test_what_the_drive_screen_says_of_it() -> None:
    one, two = PadFrame(0.0, ("One",)), PadFrame(0.0, ("One", "Two"), 1)
    assert PadState(PadFrame(0.0), PadMapping()).hint(armed=True) == "no gamepad yet"
    assert PadState(one, PadMapping()).hint(armed=False) == "gamepad: hold START (One)"
    assert PadState(two, PadMapping()).hint(armed=True) == "gamepad 2/2: hold RB (Two)"
    assert PadState(one, PadMapping()).alert == ""
    assert "centre its sticks while RB is held" in PadState(PadFrame(0.0, ("One",), uncentred=True), PadMapping()).alert
