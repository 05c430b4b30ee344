"""Terminal bytes to batches of keys: fails first when Textual changes its private key classes."""

from __future__ import annotations

import string

import pytest
from textual import events
from textual._xterm_parser import XTermParser
from textual.message import Message

from groundstation.input.keymap import KeyEvent
from groundstation.ui.terminal.key_parser import KeyEventParser, KeyRepeat, KeyUp
from tests.groundstation.ui.ptys import PRESS_W, RELEASE_W, REPEAT_W
from tests.groundstation.ui.sinks import Clock, Sink


def feed(*reads: str) -> tuple[Sink, list[Message]]:
    """Feed reads one by one."""
    sink = Sink()
    parser = KeyEventParser(sink)
    return sink, [event for data in reads for event in parser.feed(data)]


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


@pytest.mark.parametrize("character", string.ascii_letters + string.digits)
def test_a_plain_character_is_the_key_of_the_stock_parser(character: str) -> None:
    (stock,) = XTermParser().feed(character)
    _, (key,) = feed(character)
    assert isinstance(stock, events.Key)
    assert isinstance(key, events.Key)
    assert (key.key, key.character, key.aliases) == (stock.key, stock.character, stock.aliases)


def test_a_character_of_a_paste_is_no_key_if_it_is_read_alone() -> None:
    sink, found = feed("\x1b[200~", "i", "1", "\x1b[201~", "i")
    assert [press.key for batch in sink.batches for press in batch] == ["paste", "paste", "i"]
    assert [event.text for event in found if isinstance(event, events.Paste)] == ["i1"]


def test_the_release_of_a_key_has_the_name_of_its_press() -> None:
    """Shift down, W down, Shift up, W up: the last event says "w", the press said "W"."""
    sink, _ = feed("\x1b[119:87;2:1;87u", "\x1b[57441;1:3u", "\x1b[119;1:3u")
    assert sink.batches == [[KeyEvent("W")], [KeyEvent("W", release=True)]]


def test_a_cyrillic_key_drives_by_its_place_and_types_its_letter() -> None:
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
    assert feed("\x1b[?27u", "i", "\x1b[119;1;119u")[0].told == ["claim"]
    assert feed("\x1b[?1u", "\x1b[?0u", "i")[0].told == []
    assert feed(REPEAT_W)[0].told == ["exact"]
    assert feed(RELEASE_W)[0].told == ["exact"]


def test_a_character_without_the_protocol_has_no_release() -> None:
    """Terminals without flag 8 report releases of arrows and send letters as text, and so does an input method."""
    assert feed("\x1b[1;1:3A", "i", "i")[0].told == ["exact", "plain"]
    assert feed("\x1b[1;1:3A", "i", "\x1b[1;1:3A")[0].told == ["exact", "plain", "exact"]
    assert feed("i", "i")[0].told == []
    assert feed("\x1b[1;1:3A", "\x1b[200~i\x1b[201~", "\x1b[0n", "\x1b[119;;119u")[0].told == ["exact", "pong"]


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


def test_a_paste_is_a_stop_from_its_start_and_its_text_no_keys() -> None:
    sink, _ = feed("\x1b[200", "~ryi", "i" * 5000, "\x1b[20", "1~", "k")
    assert sink.batches == [[KeyEvent("paste")], [KeyEvent("paste")], [KeyEvent("k")]]


def test_an_endless_paste_does_not_keep_the_keys_for_ever() -> None:
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


@pytest.mark.parametrize("reads", [("\x1b[0n",), ("\x1b[", "0n")])
def test_answers_to_pings_do_not_keep_a_paste_open(reads: tuple[str, ...]) -> None:
    sink, clock = Sink(), Clock()
    parser = KeyEventParser(sink, clock=clock)
    parser.feed("\x1b[200~ryi")
    for _ in range(5):
        clock.now += 0.5
        for data in reads:
            parser.feed(data)
        parser.tick()
    parser.feed("!")
    assert sink.batches[-1] == [KeyEvent("exclamation_mark")]
    assert sink.told == []


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


@pytest.mark.parametrize(("text", "keys"), [(True, ["escape", "w"]), (False, ["alt+w"])])
def test_escape_and_a_character_are_two_keys_of_a_text(text: bool, keys: list[str]) -> None:
    sink = Sink()
    sink.text = text
    found = list(KeyEventParser(sink).feed("\x1bw"))
    assert [press.key for batch in sink.batches for press in batch] == keys
    assert [event.key for event in found if isinstance(event, events.Key)] == keys


def test_an_emergency_stop_behind_escape_counts_in_a_text() -> None:
    sink = Sink()
    sink.text = True
    list(KeyEventParser(sink).feed("\x1b!"))
    assert [press.key for press in sink.batches[-1]] == ["escape", "exclamation_mark"]


def test_answers_are_handed_on_whole_and_are_no_keys() -> None:
    answers, sink = list[str](), Sink()
    parser = KeyEventParser(sink, on_answer=answers.append)
    sent = ["\x1b_Gi=31;OK\x1b\\", "\x1b[6;16;8t", "\x1b[?64;1;2;4;6;9;15;16;17;18;21;22;28;29c"]
    data = "".join(sent)
    for at in range(0, len(data), 7):  # in pieces, as over a line
        list(parser.feed(data[at : at + 7]))
    assert answers == sent
    list(parser.feed("i"))
    assert [event for batch in sink.batches for event in batch] == [KeyEvent("i")]
