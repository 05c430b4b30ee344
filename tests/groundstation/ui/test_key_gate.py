"""What passes from keys to the station, with the gate open and shut."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

from groundstation.input.keymap import KeyPress
from groundstation.intents import (
    ChangeSpeed,
    Disarm,
    EmergencyStop,
    ExactKeys,
    Gate,
    Push,
    Release,
    SetMode,
    Stop,
)
from groundstation.ui.key_gate import Door, KeyGate, Shut
from tests.groundstation.ui.examples import Recorder
from tests.groundstation.ui.ptys import STANDARD

SMALL, TEXT = Shut("the terminal is too small"), Shut("another screen is open", Door.STOPS)


@pytest.fixture
def station() -> Iterator[Recorder]:
    recorder = Recorder()
    yield recorder
    recorder.close()


@pytest.fixture
def gate(station: Recorder) -> KeyGate:
    """An open one, of an armed vehicle that is not driven."""
    made = KeyGate(station, STANDARD, lambda: 0.0)
    made.set(None)
    made.observe(armed=True, driving=False)
    station.intents.clear()
    return made


def press(key: str) -> KeyPress:
    return KeyPress(key)


def test_it_is_shut_before_the_screen_has_said_otherwise(station: Recorder) -> None:
    assert KeyGate(station, STANDARD, lambda: 0.0).state is not None


def test_a_drive_key_passes_at_once(gate: KeyGate, station: Recorder) -> None:
    gate.take([press("i")])
    assert station.intents == [Push(key="i", throttle=1, steering=0)]


def test_closing_is_told_with_its_reason_and_is_a_stop(gate: KeyGate, station: Recorder) -> None:
    gate.set(SMALL)
    assert station.intents == [Gate(open=False, reason=SMALL.reason), Stop(SMALL.reason)]


def test_closing_twice_for_one_reason_is_told_once(gate: KeyGate, station: Recorder) -> None:
    gate.set(SMALL)
    gate.set(SMALL)
    assert len(station.of(Gate)) == 1
    gate.set(TEXT)
    assert station.of(Gate)[-1].reason == TEXT.reason


@pytest.mark.parametrize("shut", [SMALL, TEXT])
@pytest.mark.parametrize(("key", "kind"), [("space", Stop), ("k", Stop), ("exclamation_mark", EmergencyStop)])
def test_stops_pass_a_shut_gate(gate: KeyGate, station: Recorder, shut: Shut, key: str, kind: type) -> None:
    gate.set(shut)
    station.intents.clear()
    gate.take([press(key)])
    assert station.of(kind)


def test_drive_keys_pass_a_shut_gate_for_the_station_to_remember(gate: KeyGate, station: Recorder) -> None:
    """It has been told that the gate is shut: a key pressed now must not drive when it opens."""
    gate.set(TEXT)
    gate.take([press("i"), KeyPress("i", release=True)])
    assert station.of(Push)
    assert station.of(Release)
    assert station.of(Gate)[-1].open is False


@pytest.mark.parametrize(("key", "intent"), [("r", Disarm()), ("2", SetMode("HOLD")), ("minus", ChangeSpeed(0.9, 0.9))])
def test_commands_pass_unless_keys_are_text(gate: KeyGate, station: Recorder, key: str, intent: object) -> None:
    gate.set(SMALL)
    gate.take([press(key)])
    assert intent in station.intents
    station.intents.clear()
    gate.set(TEXT)
    gate.take([press(key)])
    assert intent not in station.intents


def test_repeats_of_a_key_held_over_a_closing_are_dropped(gate: KeyGate, station: Recorder) -> None:
    """Kitty goes on repeating after the focus is lost (seen in 0.26.5)."""
    gate.take([press("i"), KeyPress("i", repeat=True)])
    assert len(station.of(Push)) == 2
    gate.set(SMALL)
    gate.set(None)
    gate.take([KeyPress("i", repeat=True)])
    assert len(station.of(Push)) == 2
    gate.take([press("i")])
    assert len(station.of(Push)) == 3


def test_proof_of_releases_is_told_once(gate: KeyGate, station: Recorder) -> None:
    gate.exact()
    gate.exact()
    assert station.intents == [ExactKeys()]


def test_what_is_driven_decides_whether_a_strange_key_stops(gate: KeyGate, station: Recorder) -> None:
    gate.take([press("b")])
    assert station.intents == []
    gate.observe(armed=True, driving=True)
    gate.take([press("b")])
    assert station.intents == [Stop()]
