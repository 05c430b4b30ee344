"""Texts and times of messages: safe to print, and inside their fields."""

from __future__ import annotations

from dialects import codec
from dialects.messages import StatusText, boot_ms, decode_text, printable


def test_text_is_utf8_and_harmless_to_a_terminal() -> None:
    raw = "Akku schwach: 9,8 V \x1b[2J\N{HEAVY BLACK HEART}".encode()
    message = codec.decode(StatusText.id, codec.encode_payload(StatusText(severity=4, text=raw)))
    assert isinstance(message, StatusText)
    assert decode_text(message) == "Akku schwach: 9,8 V \ufffd[2J\N{HEAVY BLACK HEART}"
    assert printable("a\nb\x7f\x9b") == "a\ufffdb\ufffd\ufffd"


def test_boot_time_wraps_instead_of_raising() -> None:
    assert boot_ms(0.0) == 0
    assert boot_ms(2**32 / 1000 + 1.5) == 1500
