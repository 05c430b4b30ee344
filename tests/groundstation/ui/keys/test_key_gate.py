"""What passes from keys to the station, with the gate open and shut."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

from groundstation.input.keymap import KeyEvent
from groundstation.intents.agents import DeclineProposal, PermitProposal
from groundstation.intents.driving import DriveKeyDown, DriveKeyUp, EmergencyStop, StepLimits, Stop
from groundstation.intents.session import ReportKeyReleases, SetKeyGate
from groundstation.intents.vehicle import Arm, Disarm, SetMode
from groundstation.intents.vehicle_intent import HOLD_TIME
from groundstation.ui.keys.key_gate import (
    OPENING_TIMEOUT,
    OTHER_SCREEN,
    SHOW_PERIOD,
    TEXT_FIELD,
    GateClosure,
    GateLevel,
    KeyGate,
)
from groundstation.ui.terminal.key_parser import KeyEventParser
from tests.groundstation.held_key import event_times
from tests.groundstation.ui.examples import Recorder
from tests.groundstation.ui.ptys import STANDARD
from tests.groundstation.ui.sinks import Clock

SMALL = GateClosure("the terminal is too small")


@pytest.fixture
def station() -> Iterator[Recorder]:
    recorder = Recorder()
    yield recorder
    recorder.close()


@pytest.fixture
def gate(station: Recorder) -> KeyGate:
    """An open one, of an armed vehicle that is not driven."""
    made = KeyGate(station, STANDARD, lambda: 0.0)
    made.set_closure(None)
    made.update(armed=True, driving=False)
    station.intents.clear()
    return made


def press(key: str) -> KeyEvent:
    return KeyEvent(key)


def test_it_is_shut_before_the_screen_has_said_otherwise(station: Recorder) -> None:
    assert KeyGate(station, STANDARD, lambda: 0.0).closure is not None


def test_a_drive_key_passes_at_once(gate: KeyGate, station: Recorder) -> None:
    gate.handle_keys([press("i")])
    assert station.intents == [DriveKeyDown(key="i", throttle=1, steering=0)]


def test_closing_is_told_with_its_reason_and_is_a_stop(gate: KeyGate, station: Recorder) -> None:
    gate.set_closure(SMALL)
    assert station.intents == [SetKeyGate(open=False, reason=SMALL.reason), Stop(SMALL.reason)]


def test_closing_twice_for_one_reason_is_told_once(gate: KeyGate, station: Recorder) -> None:
    gate.set_closure(SMALL)
    gate.set_closure(SMALL)
    assert len(station.of(SetKeyGate)) == 1
    gate.set_closure(OTHER_SCREEN)
    assert station.of(SetKeyGate)[-1].reason == OTHER_SCREEN.reason


@pytest.mark.parametrize("shut", [SMALL, OTHER_SCREEN])
@pytest.mark.parametrize(("key", "kind"), [("space", Stop), ("k", Stop), ("exclamation_mark", EmergencyStop)])
def test_stops_pass_a_shut_gate(gate: KeyGate, station: Recorder, shut: GateClosure, key: str, kind: type) -> None:
    gate.set_closure(shut)
    station.intents.clear()
    gate.handle_keys([press(key)])
    assert station.of(kind)


def test_drive_keys_pass_a_shut_gate_for_the_station_to_remember(gate: KeyGate, station: Recorder) -> None:
    """It has been told that the gate is shut: a key pressed now must not drive when it opens."""
    gate.set_closure(OTHER_SCREEN)
    gate.handle_keys([press("i"), KeyEvent("i", release=True)])
    assert station.of(DriveKeyDown)
    assert station.of(DriveKeyUp)
    assert station.of(SetKeyGate)[-1].open is False


@pytest.mark.parametrize(
    ("key", "intent"), [("r", Disarm()), ("2", SetMode("HOLD")), ("minus", StepLimits(-0.1, -0.1))]
)
def test_commands_pass_unless_keys_are_text(gate: KeyGate, station: Recorder, key: str, intent: object) -> None:
    gate.set_closure(SMALL)
    gate.handle_keys([press(key)])
    assert intent in station.intents
    station.intents.clear()
    gate.set_closure(OTHER_SCREEN)
    gate.handle_keys([press(key)])
    assert intent not in station.intents


@pytest.mark.parametrize(
    ("key", "kind"), [("ctrl+k", Stop), ("exclamation_mark", EmergencyStop), ("f9", EmergencyStop)]
)
def test_stops_that_are_no_text_pass_in_a_text_field(gate: KeyGate, station: Recorder, key: str, kind: type) -> None:
    gate.set_closure(TEXT_FIELD)
    station.intents.clear()
    gate.handle_keys([press(key)])
    assert [type(intent) for intent in station.intents][:1] == [kind]


def test_text_stops_nothing_and_commands_nothing(gate: KeyGate, station: Recorder) -> None:
    """A stop key would put a vehicle on a mission into HOLD."""
    gate.set_closure(TEXT_FIELD)
    station.intents.clear()
    for keys in (["s", "k", "i", "p"], ["space"], ["i", "t"], ["r"], ["1"], ["i", "enter"], ["left", "backspace"]):
        gate.handle_keys([press(key) for key in keys])
    assert {type(intent) for intent in station.intents} == {DriveKeyDown}, "which the station rejects"


def test_keys_of_another_screen_stop_nothing(gate: KeyGate, station: Recorder) -> None:
    gate.set_closure(OTHER_SCREEN)
    station.intents.clear()
    gate.update(armed=True, driving=True)
    gate.handle_keys([press("slash"), press("up"), press("pageup"), press("w")])
    assert {type(intent) for intent in station.intents} == {DriveKeyDown}


@pytest.mark.parametrize("opener", ["f6", "ctrl+g", "question_mark", "left_square_bracket", "ctrl+p"])
@pytest.mark.parametrize("together", [True, False])
def test_a_key_that_opens_a_screen_closes_the_gate_at_once(
    gate: KeyGate, station: Recorder, opener: str, together: bool
) -> None:
    """The event loop has had no turn yet: 1 is a digit of the go-to menu, not MANUAL."""
    reads = [[press(opener), press("1"), press("2")]] if together else [[press(opener)], [press("1")], [press("2")]]
    for read in reads:
        gate.handle_keys(read)
        gate.set_closure(None)  # the loop's timer runs before it handles the key
    assert station.of(SetKeyGate)[-1].open is False
    assert not station.of(SetMode)
    gate.handle_keys([press("exclamation_mark")])
    assert station.of(EmergencyStop)


def test_the_gate_opens_again_whether_or_not_a_screen_opened(station: Recorder) -> None:
    clock = Clock()
    gate = KeyGate(station, STANDARD, clock)
    gate.set_closure(None)
    gate.handle_keys([press("f6")])
    gate.screen_opened()
    gate.set_closure(None)
    assert gate.closure is None
    gate.handle_keys([press("f6")])
    gate.set_closure(None)
    assert gate.closure == OTHER_SCREEN
    clock.now += OPENING_TIMEOUT
    gate.set_closure(None)
    assert gate.closure is None


def test_repeats_of_a_key_held_over_a_closing_are_dropped(gate: KeyGate, station: Recorder) -> None:
    """Kitty goes on repeating after the focus is lost (seen in 0.26.5)."""
    gate.handle_keys([press("i"), KeyEvent("i", repeat=True)])
    assert len(station.of(DriveKeyDown)) == 2
    gate.set_closure(SMALL)
    gate.set_closure(None)
    gate.handle_keys([KeyEvent("i", repeat=True)])
    assert len(station.of(DriveKeyDown)) == 2
    gate.handle_keys([press("i")])
    assert len(station.of(DriveKeyDown)) == 3


def test_a_promise_of_releases_is_no_proof(gate: KeyGate, station: Recorder) -> None:
    gate.handle_release_claim()
    assert gate.promises_releases
    assert station.intents == []


def test_proof_of_releases_is_told_once(gate: KeyGate, station: Recorder) -> None:
    gate.handle_release_support()
    gate.handle_release_support()
    assert station.intents == [ReportKeyReleases()]


def test_a_key_without_a_release_brings_the_timers_back(gate: KeyGate, station: Recorder) -> None:
    gate.handle_plain_key()
    assert station.intents == [], "the timers are on until a release is proved"
    for _ in range(2):
        gate.handle_release_support()
        gate.handle_plain_key()
    assert station.intents == [ReportKeyReleases(), ReportKeyReleases(reports=False)] * 2


def test_what_is_driven_decides_whether_a_strange_key_stops(gate: KeyGate, station: Recorder) -> None:
    gate.handle_keys([press("e")])
    assert station.intents == []
    gate.update(armed=True, driving=True)
    gate.handle_keys([press("e")])
    assert station.intents == [Stop()]


def hold_r(gate: KeyGate, clock: Clock, seconds: float) -> None:
    begun = clock.now
    for at in event_times(seconds):
        clock.now = begun + at
        gate.handle_keys([press("r")])


@pytest.fixture
def clock() -> Clock:
    return Clock()


@pytest.fixture
def disarmed(station: Recorder, clock: Clock) -> KeyGate:
    """An open gate, of a vehicle that is not armed."""
    made = KeyGate(station, STANDARD, clock)
    made.set_closure(None)
    made.update(armed=False, driving=False)
    return made


def test_a_held_key_arms_and_says_how_long_it_was_held(disarmed: KeyGate, station: Recorder, clock: Clock) -> None:
    hold_r(disarmed, clock, 0.9)
    assert disarmed.hold is not None
    assert not station.of(Arm)
    hold_r(disarmed, clock, 5.0)
    (arm,) = station.of(Arm)
    assert arm.held >= HOLD_TIME
    assert disarmed.hold is None


@pytest.mark.parametrize("shut", [SMALL, OTHER_SCREEN])
def test_a_shut_gate_arms_nothing(disarmed: KeyGate, station: Recorder, clock: Clock, shut: GateClosure) -> None:
    disarmed.set_closure(shut)
    hold_r(disarmed, clock, 5.0)
    assert disarmed.hold is None
    assert not station.of(Arm)


@pytest.mark.parametrize("shut", [SMALL, OTHER_SCREEN])
def test_closing_cancels_and_opening_does_not_resume(
    disarmed: KeyGate, station: Recorder, clock: Clock, shut: GateClosure
) -> None:
    hold_r(disarmed, clock, 0.9)
    disarmed.set_closure(shut)
    disarmed.set_closure(None)
    assert disarmed.hold is None
    clock.now += 0.03
    for _ in range(100):
        clock.now += 0.03
        disarmed.handle_keys([press("r")])
    assert not station.of(Arm)


def test_the_mouse_cancels(disarmed: KeyGate, station: Recorder, clock: Clock) -> None:
    hold_r(disarmed, clock, 0.9)
    disarmed.cancel_hold()
    assert disarmed.hold is None


def test_the_event_loop_need_not_see_each_repeat_of_a_drive_key(station: Recorder) -> None:
    clock = Clock()
    gate = KeyGate(station, STANDARD, clock)
    gate.set_closure(None)
    assert not gate.is_repeat("i")
    clock.now += SHOW_PERIOD / 2
    assert gate.is_repeat("i")
    assert not gate.is_repeat("k"), "a stop key"
    assert not gate.is_repeat("i"), "another key came between"
    clock.now += 2 * SHOW_PERIOD
    assert not gate.is_repeat("i")
    gate.handle_keys([KeyEvent("i", release=True)])
    assert not gate.is_repeat("i"), "it was released"
    gate.set_closure(SMALL)
    assert not gate.is_repeat("i"), "it does not drive"


def test_each_repeat_still_reaches_the_station(gate: KeyGate, station: Recorder) -> None:
    parser = KeyEventParser(gate)
    shown = [len(list(parser.feed("i"))) for _ in range(3)]
    assert shown == [1, 0, 0]
    assert len(station.of(DriveKeyDown)) == 3


@pytest.mark.parametrize("text", ["oil", "speed", "1gr", "GY1", "mjlu"])
@pytest.mark.parametrize("driving", [False, True])
def test_a_burst_of_characters_never_drives(gate: KeyGate, station: Recorder, text: str, driving: bool) -> None:
    gate.handle_keys([press("i")])
    assert len(station.of(DriveKeyDown)) == 1, "a key alone drives"
    gate.update(armed=True, driving=driving)
    station.intents.clear()
    gate.handle_keys([press(character) for character in text])
    assert station.intents == ([Stop()] if driving else [])
    assert gate.bursts == 1


def test_stops_and_releases_in_a_burst_count(gate: KeyGate, station: Recorder) -> None:
    gate.handle_keys([press("a"), press("b"), press("exclamation_mark"), KeyEvent("i", release=True)])
    assert station.intents == [EmergencyStop(), Stop(), DriveKeyUp(key="i")]


def test_a_chord_and_a_key_that_repeats_are_no_burst(gate: KeyGate, station: Recorder) -> None:
    gate.handle_keys([press("u"), press("i"), press("u"), press("i")])
    assert len(station.of(DriveKeyDown)) == 4
    gate.handle_keys([press("up"), press("left"), press("i"), press("up")])
    assert len(station.of(DriveKeyDown)) == 8
    assert gate.bursts == 0


def test_a_text_behind_the_key_of_a_screen_is_no_burst(gate: KeyGate) -> None:
    gate.handle_keys([press(key) for key in ("colon", "m", "a", "p")])
    assert (gate.bursts, gate.closure) == (0, OTHER_SCREEN)


def test_a_text_field_is_told_to_the_parser(gate: KeyGate) -> None:
    assert not gate.takes_text()
    gate.set_closure(OTHER_SCREEN)
    assert not gate.takes_text()
    gate.set_closure(TEXT_FIELD)
    assert gate.takes_text()


LOG = GateClosure(OTHER_SCREEN.reason, GateLevel.STOPS, frozenset(("p", "P")))
"""Under a screen that has no use for these keys, and shows what agents propose."""


@pytest.mark.parametrize(("shut", "counts"), [(LOG, True), (OTHER_SCREEN, False), (TEXT_FIELD, False), (SMALL, False)])
def test_the_key_of_a_proposal_counts_where_the_gate_says_so(
    station: Recorder, shut: GateClosure, counts: bool
) -> None:
    now = [0.0]
    gate = KeyGate(station, STANDARD, lambda: now[0])
    gate.update(armed=False, driving=False, proposal=3)
    gate.set_closure(shut)
    assert station.of(SetKeyGate)[-1].permits == counts
    for key in ("r", "Z", "p"):
        for at in event_times(2.0):
            gate.handle_keys([press(key)])
            now[0] += 0.033 if at else 0.4
        now[0] += 2.0
    assert {each.number for each in station.of(PermitProposal)} == ({3} if counts else set())
    assert not station.of(Arm)
    gate.handle_keys([press("P")])
    assert bool(station.of(DeclineProposal)) == (counts or shut is SMALL)
