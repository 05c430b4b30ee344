"""Escape sequences that a slow line splits: what is left of them is not a key, and stop keys still stop."""

from __future__ import annotations

import asyncio
from collections.abc import Iterator, Sequence

import pytest
from hypothesis import given
from hypothesis import strategies as st
from textual import events
from textual.message import Message

from groundstation.input.keymap import KeyEvent
from groundstation.intents.driving import DriveKeyDown, DriveKeyUp, EmergencyStop, Stop
from groundstation.intents.session import ReportKeyReleases, SetKeyGate
from groundstation.intents.union import AnyIntent
from groundstation.intents.vehicle import SetMode
from groundstation.ui.keys.key_gate import KeyGate
from groundstation.ui.terminal.escape_sequences import MAX_LENGTH, OPEN_TIME, Piece, SequenceAssembler
from groundstation.ui.terminal.key_parser import KeyEventParser
from tests.groundstation.ui.examples import Recorder
from tests.groundstation.ui.ptys import PRESS_W, RELEASE_W, REPEAT_W, STANDARD, app_on_a_pty
from tests.groundstation.ui.sequences import STOPS, every_sequence, is_stop
from tests.groundstation.ui.sinks import Clock, Sink
from tests.waits import until

TICK = 0.05
SEQUENCES = every_sequence()
NEUTRAL = (Stop, SetKeyGate, ReportKeyReleases, DriveKeyUp)
"""What may come of a split sequence. The gate closes when the focus is lost."""


class Line:
    """A slow line to the parser and the open gate of an armed vehicle that is driven."""

    def __init__(self, station: Recorder) -> None:
        self.clock = Clock()
        self.station = station
        self.gate = KeyGate(station, STANDARD, self.clock)
        self.gate.set_closure(None)
        self.gate.update(armed=True, driving=True)
        self.parser = KeyEventParser(self.gate, clock=self.clock)
        self.events: list[Message] = []

    def send(self, reads: Sequence[str], gap: float) -> list[AnyIntent]:
        """Let reads arrive, `gap` s apart; return what passed the gate."""
        self.station.intents.clear()
        self.events.clear()
        for read in reads:
            self.events += self.parser.feed(read)
            for _ in range(round(gap / TICK)):
                self.clock.now += TICK
                self.events += self.parser.tick()
        return list(self.station.intents)

    @property
    def keys(self) -> set[str]:
        """The keys that screens get."""
        return {event.key for event in self.events if isinstance(event, events.Key)}


@pytest.fixture
def line() -> Iterator[Line]:
    station = Recorder()
    yield Line(station)
    station.close()


def test_whole_keys_drive_and_change_modes(line: Line) -> None:
    assert line.send(["\x1b[A"], 0.2) == [DriveKeyDown(key="up", throttle=1, steering=0)]
    line.gate.update(armed=True, driving=False)
    assert line.send(["1"], 0.2) == [SetMode(mode="MANUAL")]
    line.send(["\x1b[17~"], 0.2)
    assert line.keys == {"f6"}


@pytest.mark.parametrize("gap", [0.2, 0.9])
def test_each_sequence_split_at_each_byte_is_nothing_but_neutral(line: Line, gap: float) -> None:
    for name, sequence in SEQUENCES.items():
        for cut in range(1, len(sequence)):
            passed = line.send([sequence[:cut], sequence[cut:]], gap)
            line.send([], OPEN_TIME + 0.2)
            if not is_stop(sequence):
                assert all(isinstance(intent, NEUTRAL) for intent in passed), (name, cut, passed)
            whole = {"paste with a colour", "paste"} & {name}  # a paste is an event of its own
            assert whole or line.keys <= {"escape"}, (name, cut, line.keys)


def test_each_sequence_in_single_bytes_is_nothing_but_neutral(line: Line) -> None:
    for name, sequence in SEQUENCES.items():
        passed = line.send(list(sequence), 0.2)
        line.send([], OPEN_TIME + 0.2)
        if not is_stop(sequence):
            assert all(isinstance(intent, NEUTRAL) for intent in passed), (name, passed)
        assert line.keys <= {"escape"}, (name, line.keys)


def test_each_whole_sequence_leaves_nothing_behind(line: Line) -> None:
    """The stock parser takes a sequence that it does not know for the keys that it is made of."""
    for name, sequence in SEQUENCES.items():
        line.send([sequence], OPEN_TIME + 3.0)
        assert not line.station.of(SetMode), name
        line.send(["k"], 0.2)
        assert line.keys == {"k"}, name


@pytest.mark.parametrize("stop", [" ", "k", "\x0b", "!", "\x1b[20~"], ids=repr)
def test_a_stop_key_right_behind_a_split_sequence_stops(line: Line, stop: str) -> None:
    kind = EmergencyStop if stop in ("!", "\x1b[20~") else Stop
    for name, sequence in SEQUENCES.items():
        if sequence.startswith("\x1b[200~"):
            continue  # a paste of which the rest is text
        for cut in range(1, len(sequence) + 1):
            for gap in (0.0, 0.2):
                line.gate.set_closure(None)
                line.send([sequence[:cut]], gap)
                passed = line.send([sequence[cut:] + stop], 0.2)
                assert any(isinstance(intent, kind) for intent in passed), (name, cut, gap)


@pytest.mark.parametrize("stop", [" ", "k", "\x0b", "!", "\x1b[20~"], ids=repr)
def test_a_stop_key_behind_a_sequence_without_its_end_stops(line: Line, stop: str) -> None:
    kind = EmergencyStop if stop in ("!", "\x1b[20~") else Stop
    for name, sequence in SEQUENCES.items():
        if sequence.startswith(("\x1b[200~", "\x1b[M")):  # a report in the X10 encoding may hold any character
            continue
        for cut in range(1, len(sequence)):
            line.gate.set_closure(None)
            passed = line.send([sequence[:cut]], 0.2) + line.send([stop], 0.2)
            line.send([], OPEN_TIME + 0.2)
            assert any(isinstance(intent, kind) for intent in passed), (name, cut)


@pytest.mark.parametrize("sequence", STOPS.values(), ids=STOPS)
def test_a_split_stop_key_still_stops(line: Line, sequence: str) -> None:
    line.gate.update(armed=True, driving=False)
    for cut in range(1, len(sequence)):
        passed = line.send([sequence[:cut], sequence[cut:]], 0.2)
        line.send([], OPEN_TIME + 0.2)
        assert any(isinstance(intent, (Stop, EmergencyStop)) for intent in passed), cut


def test_a_split_release_still_releases(line: Line) -> None:
    """A lost release would leave the key held."""
    for cut in range(2, len(RELEASE_W)):
        assert DriveKeyDown(key="w", throttle=1, steering=0) in line.send([PRESS_W, REPEAT_W], 0.0)
        assert DriveKeyUp(key="w") in line.send([RELEASE_W[:cut], RELEASE_W[cut:]], 0.2), cut


def test_a_lone_escape_is_the_key_after_the_usual_delay() -> None:
    sink, clock = Sink(), Clock()
    parser = KeyEventParser(sink, clock=clock)
    for _ in range(2):
        parser.feed("\x1b")
        clock.now += 0.11
        parser.tick()
    assert sink.batches == [[KeyEvent("escape")], [KeyEvent("escape")]]
    clock.now += OPEN_TIME
    parser.tick()
    parser.feed("1")
    assert sink.batches[2:] == [[KeyEvent("1")]]


def test_a_key_within_a_second_after_a_lone_escape_is_neutral(line: Line) -> None:
    """The bytes are those of Alt and 1 on a slow line."""
    assert line.send(["\x1b"], 0.5) == [Stop()]
    assert line.send(["1"], 0.2) == [Stop()]
    assert line.send(["\x1b"], OPEN_TIME + 0.1) == [Stop()]
    assert line.send(["i"], 0.2) == [DriveKeyDown(key="i", throttle=1, steering=0)]


def test_a_sequence_in_pieces_that_come_soon_is_the_key(line: Line) -> None:
    line.send(["\x1b[", "17", "~"], 0.05)
    assert line.keys == {"f6"}


def test_a_split_answer_of_the_terminal_does_not_stop(line: Line) -> None:
    assert line.send(["\x1b[", "0n"], 0.2) == []


def test_a_split_key_is_counted_for_the_hint(line: Line) -> None:
    line.send(["\x1b[", "17~"], 0.2)
    line.send(["\x1b[", "0n"], 0.2)
    line.send(["\x1b[1", ""], OPEN_TIME + 0.2)
    assert line.gate.split_keys == 2


def test_escape_sequences_in_a_paste_are_no_keys(line: Line) -> None:
    """Textual takes what follows one, up to 32 characters, for keys."""
    line.send(["\x1b[200~a\x1b[31m1m,i[ 1 2 3 iiii iiii iiii iiii iiii\x1b[201~"], 0.2)
    assert not line.station.of(SetMode)
    assert not line.station.of(DriveKeyDown)
    line.send(["\x1b[200~\x1b", "[31m1i\x1b[20", "1~"], 0.2)
    assert not line.station.of(SetMode)
    assert line.send(["k"], 0.2) == [Stop()]


@given(st.lists(st.sampled_from(["\x1b", "[", "O", "<", "M", "P", "1", ";", "i", "\x07", "$", "é"]), max_size=200))
def test_any_characters_end_within_a_bound(characters: list[str]) -> None:
    sequences = SequenceAssembler()
    for number, character in enumerate(characters):
        sequences.feed(character, number * 0.01)
        assert len(sequences._held) <= MAX_LENGTH
    sequences.expire(len(characters) * 0.01 + OPEN_TIME + 0.1)
    assert sequences.feed("i", 1000.0) == [Piece("i")]


async def test_split_keys_on_a_pty_change_neither_mode_nor_screen(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("groundstation.ui.app.app.PING", "")
    for _ in range(5):
        if await _split_keys_were_neutral():
            return
    raise AssertionError("this machine delays bytes by more than a split key may take, five times in a row")


async def _split_keys_were_neutral() -> bool:
    """Type split keys and check what they do; return False if the machine has delayed a piece for too long."""
    clock = asyncio.get_running_loop().time
    async with app_on_a_pty() as (app, station, terminal):
        for sequence in ("\x1b[15~", "\x1b[17~", "\x1bOQ", "\x1b1", "\x1b[A", "\x1b[49;1:1;49u"):
            for cut in (1, len(sequence) - 1):
                begun = clock()
                await terminal.type_each([sequence[:cut], sequence[cut:]], 0.35)
                if clock() - begun > 2 * 0.35 + 0.2:
                    return False
                assert app.screen is app.drive
        assert not station.of(SetMode)
        assert not station.of(DriveKeyDown)
        terminal.type("\x1b[1")
        await terminal.type_each(["\x1b[20", "~"], 0.35)
        await until(lambda: station.of(EmergencyStop))
        await until(lambda: "arrived in pieces" in terminal.drawn.decode(errors="replace"))
    return True
