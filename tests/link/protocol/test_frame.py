"""Bytes without any frame are noise, or a wrong baud rate."""

from __future__ import annotations

from dialects.messages import Heartbeat
from link.core import LinkReport
from link.protocol.channel import Channel
from link.protocol.frame import Header, read_header
from tests.link.frames import heartbeat, version_1


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


def test_a_header_is_read_where_one_begins_and_is_whole() -> None:
    data = heartbeat(7)
    assert read_header(data) == Header(0, 255, 190, 7, len(data))
    assert read_header(b"noise" + data, 5) == read_header(data)
    old = version_1(Heartbeat(6, 8, 0, 0, 4, 3), 8)
    assert read_header(old) == Header(0, 255, 190, 8, len(old))
    for none in (data[1:], data[:11], old[:7], data[:2] + b"\x02" + data[3:]):
        assert read_header(none) is None
    signed = data[:2] + b"\x01" + data[3:]
    header = read_header(signed)
    assert header is not None
    assert header.size == len(data) + 13
