"""Bytes of terminals to batches of keys: the tripwire for Textual's private key classes."""

from __future__ import annotations

import asyncio
from collections.abc import Sequence

import pytest
from textual import events
from textual.message import Message

from groundstation.input.keymap import KeyEvent
from groundstation.intents import DriveKeyDown, DriveKeyUp, EmergencyStop, ReportKeyReleases, SetKeyGate, Stop
from groundstation.ui.key_gate import GateClosure
from groundstation.ui.terminal import KeyEventParser, KeyRepeat, KeyUp
from tests.groundstation.ui.ptys import app_on_a_pty, until


class Sink:
    """Notes what it is told."""

    def __init__(self) -> None:
        self.batches: list[list[KeyEvent]] = []
        self.told: list[str] = []

    def handle_keys(self, batch: Sequence[KeyEvent]) -> None:
        self.batches.append(list(batch))

    def handle_release_support(self) -> None:
        self.told.append("exact")

    def close(self, reason: str) -> None:
        self.told.append(f"shut: {reason}")

    def handle_pong(self) -> None:
        self.told.append("pong")


def feed(*reads: str) -> tuple[Sink, list[Message]]:
    """Feed reads one by one."""
    sink = Sink()
    parser = KeyEventParser(sink)
    return sink, [event for data in reads for event in parser.feed(data)]


PRESS_W, REPEAT_W, RELEASE_W = "\x1b[119;1:1;119u", "\x1b[119;1:2;119u", "\x1b[119;1:3u"


@pytest.mark.parametrize(
    ("data", "keys"),
    [
        ("i", [KeyEvent("i")]),
        ("ik", [KeyEvent("i"), KeyEvent("k")]),
        (" ", [KeyEvent("space")]),
        (",", [KeyEvent("comma")]),
        ("\x1b[A", [KeyEvent("up")]),
        ("\x1b[20~", [KeyEvent("f9")]),
        ("\x1b[119;;119u", [KeyEvent("w")]),
        (PRESS_W, [KeyEvent("w")]),
        (REPEAT_W, [KeyEvent("w", repeat=True)]),
        (PRESS_W + RELEASE_W, [KeyEvent("w"), KeyEvent("w", release=True)]),
        ("\x1b[1;1:3A", [KeyEvent("up", release=True)]),
        ("\x1b[99;5u", [KeyEvent("ctrl+c")]),
        ("\x1b[33;2:1;33u", [KeyEvent("exclamation_mark")]),
        ("\x1b[49:33;2;33u", [KeyEvent("exclamation_mark")]),
        ("\x1b[200~ik\x1b[201~", [KeyEvent("paste")]),
        ("\x1b[?2048$p!", [KeyEvent("exclamation_mark")]),
        ("\x1b[?1;2!", [KeyEvent("exclamation_mark")]),
        ("\x1b[?2048$ ", [KeyEvent("space")]),
        ("\x1b[\x11", [KeyEvent("ctrl+q")]),
        ("\x1b[119;1\x03", [KeyEvent("ctrl+c")]),
    ],
    ids=repr,
)
def test_one_read_is_one_batch(data: str, keys: list[KeyEvent]) -> None:
    sink, _ = feed(data)
    assert sink.batches == [keys]


def test_the_release_of_a_key_has_the_name_of_its_press() -> None:
    """Shift down, W down, Shift up, W up: the last event says "w", the press said "W"."""
    sink, _ = feed("\x1b[119:87;2:1;87u", "\x1b[57441;1:3u", "\x1b[119;1:3u")
    assert sink.batches == [[KeyEvent("W")], [KeyEvent("W", release=True)]]


def test_a_key_of_a_cyrillic_layout_drives_by_its_place_and_still_types_its_letter() -> None:
    sink, found = feed("\x1b[1096::105;1:1;1096u", "\x1b[1096::105;1:3u")
    assert sink.batches == [[KeyEvent("i")], [KeyEvent("i", release=True)]]
    assert isinstance(found[0], events.Key)
    assert found[0].character == "ш"


def test_a_key_of_a_latin_layout_keeps_its_letter() -> None:
    """AZERTY: the key in Q's place types an a and means a, for that is printed on it and on the screen."""
    assert feed("\x1b[97::113;1:1;97u")[0].batches == [[KeyEvent("a")]]


def test_modifiers_alone_are_no_keys() -> None:
    """Shift on the way to "!" must not stop a drive."""
    sink, _ = feed("\x1b[57441;2:1u", "\x1b[57441;2:2u", "\x1b[57441;1:3u")
    assert sink.batches == []


def test_only_a_subfield_proves_that_releases_come() -> None:
    """Contour answers "27" and then sends none: believing it would mean a key that is never let go."""
    assert feed("\x1b[?27u", "i", "\x1b[119;1;119u")[0].told == []
    assert feed(REPEAT_W)[0].told == ["exact"]
    assert feed(RELEASE_W)[0].told == ["exact"]


@pytest.mark.parametrize("report", ["\x1b[?27u", "\x1b[?0u", "\x1b[0n", "\x1b[3n"])
def test_reports_are_not_typed(report: str) -> None:
    sink, found = feed(report, report + "i")
    assert sink.batches == [[KeyEvent("i")]]
    assert [event.key for event in found if isinstance(event, events.Key)] == ["i"]


def test_a_pong_is_told() -> None:
    assert feed("\x1b[0n")[0].told == ["pong"]


def test_a_sequence_may_come_in_pieces() -> None:
    assert feed(*PRESS_W)[0].batches == [[KeyEvent("w")]]


def test_lost_focus_shuts_in_the_same_read() -> None:
    sink, found = feed("i\x1b[O")
    assert sink.told == ["shut: the terminal window has lost the focus"]
    assert isinstance(found[-1], events.AppBlur)


class Clock:
    now = 100.0

    def __call__(self) -> float:
        return self.now


def test_a_paste_is_a_stop_from_its_first_moment_on_and_its_text_is_no_keys() -> None:
    sink, _ = feed("\x1b[200", "~ryi", "i" * 5000, "\x1b[20", "1~", "k")
    assert sink.batches == [[KeyEvent("paste")], [KeyEvent("paste")], [KeyEvent("k")]]


def test_a_paste_whose_end_never_comes_does_not_keep_the_keys_for_ever() -> None:
    sink, clock = Sink(), Clock()
    parser = KeyEventParser(sink, clock=clock)
    parser.feed("\x1b[200~ryi")
    clock.now += 1.9
    parser.tick()
    parser.feed("!")
    assert sink.batches == [[KeyEvent("paste")]]
    clock.now += 1.9
    parser.tick()
    assert sink.batches == [[KeyEvent("paste")]]
    clock.now += 0.2
    parser.tick()
    parser.feed("!")
    assert sink.batches[1:] == [[KeyEvent("paste")], [KeyEvent("exclamation_mark")]]


@pytest.mark.parametrize("size", ["99999;80", "24;99999"])
def test_no_terminal_is_as_large_as_that(size: str) -> None:
    """Its text would be drawn for minutes, and no key would be looked at."""
    assert feed(f"\x1b[48;{size};1;1t")[1] == []
    [event] = feed("\x1b[48;24;80;1;1t")[1]
    assert isinstance(event, events.Resize)


def test_widgets_get_repeats_as_keys_and_releases_apart() -> None:
    _, found = feed(PRESS_W + REPEAT_W + RELEASE_W)
    assert [type(event) for event in found] == [events.Key, KeyRepeat, KeyUp]
    assert KeyRepeat.handler_name == events.Key.handler_name


@pytest.mark.parametrize(
    "noise", ["\x1b[;;;u", "\x1b[1;1:9u", "\x1b[99999999;1:3u", "\x1b[1:::;1:3~", "\x1b[:3u", "\x1b[\x1b["]
)
def test_noise_does_not_raise(noise: str) -> None:
    sink, _ = feed(noise, "i" * 40)  # more than the longest sequence: what was begun is given up
    assert KeyEvent("i") in sink.batches[-1]


# ---- with a real pseudo-terminal and the real app ----


async def test_a_key_and_its_release_arrive_as_intents() -> None:
    async with app_on_a_pty() as (app, station, terminal):
        terminal.type(PRESS_W)
        await until(lambda: station.of(DriveKeyDown))
        terminal.type(REPEAT_W + RELEASE_W)
        await until(lambda: station.of(DriveKeyUp))
        assert app.gate.closure is None
        assert [push.repeat for push in station.of(DriveKeyDown)] == [False, True]
        assert station.of(ReportKeyReleases) == [ReportKeyReleases()]


async def test_the_terminal_is_asked_for_releases() -> None:
    async with app_on_a_pty() as (_, _, terminal):
        await until(lambda: b"\x1b[=31;1u\x1b[?u" in terminal.drawn)


async def test_a_stop_in_the_same_read_wins() -> None:
    async with app_on_a_pty() as (_, station, terminal):
        terminal.type("i")
        await until(lambda: station.of(DriveKeyDown))
        before = len(station.wishes)
        terminal.type("ik")
        await until(lambda: station.of(Stop))
        assert station.wishes[before:] == [Stop()]


async def test_keys_that_come_together_leave_the_help_once_and_the_drive_screen_where_it_is() -> None:
    async with app_on_a_pty() as (app, station, terminal):
        terminal.type("?")
        await until(lambda: app.screen is not app.drive)
        terminal.type("xyzxyz")
        await until(lambda: app.screen is app.drive)
        terminal.type("i")
        await until(lambda: station.of(DriveKeyDown))
        assert app.screen is app.drive


async def test_no_key_of_a_thousand_is_lost_at_5_ms_gaps() -> None:
    async with app_on_a_pty() as (_, station, terminal):
        keys = "ijl," * 250
        await terminal.type_each(keys, 0.005)
        await until(lambda: len(station.of(DriveKeyDown)) >= len(keys))
        names = {"i": "i", "j": "j", "l": "l", ",": "comma"}
        assert [push.key for push in station.of(DriveKeyDown)] == [names[key] for key in keys]


async def test_no_key_of_a_heap_is_lost() -> None:
    async with app_on_a_pty() as (_, station, terminal):
        terminal.type("ijl," * 250)
        await until(lambda: len(station.of(DriveKeyDown)) == 1000)


async def test_lost_focus_closes_the_gate_and_stops() -> None:
    async with app_on_a_pty() as (app, station, terminal):
        terminal.type("i\x1b[O")
        await until(lambda: any("focus" in stop.reason for stop in station.of(Stop)))
        await until(lambda: not app.app_focus)  # until then a beat of the loop may open it again
        await until(lambda: station.of(SetKeyGate)[-1].open is False)
        terminal.type("\x1b[I")
        await until(lambda: app.gate.closure is None)


async def test_a_terminal_that_stops_answering_closes_the_gate_until_it_answers_again() -> None:
    async with app_on_a_pty() as (app, station, terminal):
        await until(lambda: app.gate.ping.round_trip is not None)
        terminal.answers = False
        await until(lambda: app.gate.closure == GateClosure("the terminal does not answer"))
        assert station.of(Stop)
        terminal.answers = True
        await until(lambda: app.gate.closure is None)


async def test_a_terminal_that_never_answers_may_drive() -> None:
    async with app_on_a_pty() as (app, _, terminal):
        terminal.answers = False
        app.gate.ping.__init__()  # type: ignore[misc]
        begun = asyncio.get_running_loop().time()
        await until(lambda: asyncio.get_running_loop().time() > begun + 1.2)
        assert app.gate.closure is None


async def test_the_end_of_the_terminal_is_the_end_of_the_app() -> None:
    async with app_on_a_pty() as (app, station, terminal):
        terminal.type("i")
        await until(lambda: station.of(DriveKeyDown))
        terminal.hang_up()
        await until(lambda: not app.is_running)
        assert station.of(Stop)
        assert app.return_value == 129


async def test_the_emergency_stop_works_in_the_palette() -> None:
    async with app_on_a_pty() as (app, station, terminal):
        terminal.type("\x10")  # ctrl+p
        await until(lambda: app.screen is not app.drive)
        terminal.type("!")
        await until(lambda: station.of(EmergencyStop))
