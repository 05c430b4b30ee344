"""Texts and times of messages: safe to print, and inside their fields."""

from __future__ import annotations

from dialects import codec
from dialects.messages import RoverStationEvent, StatusText, boot_ms, decode_text, encode_text
from dialects.printable import printable


def test_text_is_utf8_and_harmless_to_a_terminal() -> None:
    raw = "Akku schwach: 9,8 V \x1b[2J\N{HEAVY BLACK HEART}".encode()
    message = codec.decode(StatusText.id, codec.encode_payload(StatusText(severity=4, text=raw)))
    assert isinstance(message, StatusText)
    assert decode_text(message) == "Akku schwach: 9,8 V \ufffd[2J\N{HEAVY BLACK HEART}"
    assert printable("a\nb\x7f\x9b") == "a\ufffdb\ufffd\ufffd"


def test_boot_time_wraps_instead_of_raising() -> None:
    assert boot_ms(0.0) == 0
    assert boot_ms(2**32 / 1000 + 1.5) == 1500


def test_a_long_text_is_cut_between_characters() -> None:
    text = "neutral: " + "\N{HEAVY BLACK HEART}" * 40  # 3 bytes each
    event = RoverStationEvent(10, 4, 1, 0, 0, encode_text(text, 100))
    read = codec.decode(RoverStationEvent.id, codec.encode_payload(event))
    assert isinstance(read, RoverStationEvent)
    assert decode_text(read) == "neutral: " + "\N{HEAVY BLACK HEART}" * 30
    assert encode_text("\udc80", 9) == b"?"  # half a character, as from a file name that is not UTF-8


def test_a_tab_that_ends_a_text_of_px4_is_not_a_part_of_it() -> None:
    assert decode_text(StatusText(6, b"Armed by external command\t")) == "Armed by external command"
    assert decode_text(StatusText(6, b"a\tb")) == "a b"
