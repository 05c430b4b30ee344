"""RADIO_STATUS of a telemetry radio limits the link, and a silent radio does not."""

from __future__ import annotations

import pytest

from dialects.messages import RadioStatus
from link.protocol.channel import Channel
from tests.link.frames import frame


def test_a_radio_that_is_full_asks_for_less() -> None:
    channel = Channel("serial:/dev/ttyX:57600", 0, system=1, component=1, stream=True, target="x", capacity=5760.0)
    assert (channel.report().capacity, channel.report().headroom) == (5760.0, 1.0)
    for number in range(10):
        channel.receive(_radio_status(number, txbuf=10), "x", float(number))
    low = channel.report(now=10.0).headroom
    assert low == pytest.approx(0.25)
    for number in range(10, 40):
        channel.receive(_radio_status(number, txbuf=99), "x", float(number))
    assert channel.report(now=40.0).headroom == 1.0


def test_a_radio_that_fell_silent_limits_nothing() -> None:
    channel = Channel("serial:/dev/ttyX:57600", 0, system=1, component=1, stream=True, target="x", capacity=5760.0)
    channel.receive(_radio_status(0, txbuf=1), "x", 0.0)
    assert channel.report(now=1.0).headroom < 1.0
    assert channel.report(now=9.0).headroom == 1.0


def _radio_status(number: int, txbuf: int) -> bytes:
    return frame(RadioStatus(200, 200, txbuf, 30, 30, 0, 0), number, 51, 68)
