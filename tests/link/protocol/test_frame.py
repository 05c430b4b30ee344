"""Bytes without any frame are noise, or a wrong baud rate."""

from __future__ import annotations

from link.core import LinkReport
from link.protocol.channel import Channel
from tests.link.frames import heartbeat


def told(*pieces: bytes) -> LinkReport:
    channel = Channel("serial:/dev/ttyX:57600", 0, system=1, component=1, stream=True, target="x", capacity=5760.0)
    for number, data in enumerate(pieces):
        channel.receive(data, "x", number * 0.05)
    return channel.report()


def test_modem_manager_is_only_noise() -> None:
    report = told(b"AT\r", b"AT\r", b"AT+GCAP\r", heartbeat(0))
    assert (report.frames, report.resync_bytes, report.down) == (1, 14, None)


def test_noise_and_nothing_else_is_called_a_wrong_baud_rate() -> None:
    assert told(b"\x80\xf8" * 100).down is None
    assert "wrong baud rate?" in (told(*[b"\x80\xf8" * 100] * 3).down or "")
    assert told(*[b"\x80\xf8" * 100] * 3, heartbeat(0)).down is None
