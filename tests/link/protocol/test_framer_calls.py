"""What the framer calls for the frames that arrive most, and that its short cut accepts nothing but these.

Calls cost more than all else there (docs/performance.md), so that each one too many is a fault, although the frames
that come out are the same.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial

import pytest
from fastcrc.crc16 import mcrf4xx

from dialects.codec import CRC_EXTRA
from link.protocol.checksum import START
from link.protocol.frame import Frame
from link.protocol.framer import PARTIAL_DEADLINE, Framer
from tests.link.calls import called
from tests.link.frames import demand
from tests.rows import each_row

LARGE_ID = 0x012345
"""Id of a message of a user's dialect: three different bytes."""


@pytest.fixture(autouse=True)
def _large_id(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(CRC_EXTRA, LARGE_ID, b"\x77")


def build(
    length: int, number: int = 0, *, flags: int = 0, magic: int = 0xFD, claimed: int | None = None, tail: bytes = b""
) -> bytes:
    """A frame with a right checksum. `claimed`: the length in its header, where that is wrong."""
    header = bytes([magic, length if claimed is None else claimed, flags, 0, 7, 1, 2]) + number.to_bytes(3, "little")
    body = header + bytes(range(1, length + 1))
    return body + mcrf4xx(body + CRC_EXTRA[number], START).to_bytes(2, "little") + tail


def found(framer: Framer, data: bytes, calls: Sequence[str]) -> list[Frame]:
    """The frames in `data`, which must take these calls alone."""
    frames: list[Frame] = []
    assert called(lambda: frames.extend(framer.feed(data, 0.0))) == ["feed", *calls]
    return frames


@each_row("length", [0, 1, 2, 9, 127, 128, 254, 255])
@each_row("number", [0, 69, 397, LARGE_ID])
def test_a_datagram_of_one_frame_takes_no_call(length: int, number: int) -> None:
    framer, data = Framer(stream=False), build(length, number)
    for _ in range(2):
        assert found(framer, data, []) == [(number, 1, 2, 7, data)]
    assert framer.counts.frames == 2


@pytest.mark.parametrize("number", [0, LARGE_ID])
@pytest.mark.parametrize("length", [0, 1, 2, 255])
def test_a_datagram_of_one_signed_frame_is_not_searched(length: int, number: int) -> None:
    framer, data = Framer(stream=False), build(length, number, flags=1, tail=bytes(range(50, 63)))
    for _ in range(2):
        assert found(framer, data, ["_feed_unusual", "read_header"]) == [(number, 1, 2, 7, data)]
    assert framer.counts.frames == 2


@pytest.mark.parametrize("length", [0, 9])
def test_a_datagram_of_an_unknown_id_is_not_searched(length: int) -> None:
    data = bytearray(build(length, LARGE_ID))
    data[9] = 0xEE
    framer = Framer(stream=False)
    for times in (1, 2):
        assert found(framer, bytes(data), ["_feed_unusual", "read_header", "add_unknown"]) == []
        assert framer.counts.unknown_ids == {(1, 2, 0xEE2345): (times, len(data))}
    assert framer.counts.unknown == 2


@pytest.mark.parametrize("stream", [False, True])
@pytest.mark.parametrize("number", [0, LARGE_ID])
def test_frames_that_arrive_together_take_no_call_each(stream: bool, number: int) -> None:
    framer, several = Framer(stream=stream), [build(length, number) for length in (0, 1, 255, 0)]
    once = (
        ["_feed_stream", "_take", "_scan", "shift"]
        if stream
        else ["_feed_unusual", "read_header", "_scan", "settle", "drop"]
    )
    frames = found(framer, b"".join(several), once)
    assert frames == [(number, 1, 2, 7, data) for data in several]
    assert framer.counts.frames == 4


def test_stream_is_searched_at_known_length_and_at_a_whole_frame() -> None:
    framer, data = Framer(stream=True), demand(1) + demand(2)
    calls = [called(partial(framer.feed, data[at : at + 1], 0.0)) for at in range(len(data))]
    searched = [at for at, names in enumerate(calls, 1) if "_scan" in names]
    assert searched == [1, 12, 23, 24, 35, 46]


def test_a_frame_of_known_length_waits_for_its_last_byte() -> None:
    framer = Framer(stream=True)
    assert len(framer.feed(demand(1) + demand(2)[:12], 50.0)) == 1
    assert called(lambda: framer.feed(demand(2)[12:22], 50.0)) == ["feed", "_feed_stream"]
    assert len(framer.feed(demand(2)[22:], 50.0 + PARTIAL_DEADLINE / 2)) == 1


WRONG = {
    "another start byte": build(9, magic=0xFC),
    "a length beyond the datagram": build(9, claimed=10),
    "a length inside the datagram": build(9, claimed=8),
    "a flag that nobody knows": build(9, flags=2),
}


@pytest.mark.parametrize("stream", [False, True])
@pytest.mark.parametrize("data", WRONG.values(), ids=WRONG)
def test_a_right_checksum_alone_makes_no_frame(data: bytes, stream: bool) -> None:
    framer = Framer(stream=stream)
    frames = framer.feed(data, 0.0) + framer.feed(data + demand(3), 0.0) + framer.expire(10 * PARTIAL_DEADLINE)
    assert [raw for *_, raw in frames] == [demand(3)]


def test_a_datagram_without_its_announced_signature_is_no_frame() -> None:
    framer = Framer(stream=False)
    assert framer.feed(build(9, flags=1), 0.0) == []
    assert framer.counts.frames == 0


@each_row("stream", [False, True])
@each_row("number", [0, 69, LARGE_ID])
@each_row("signed", [False, True])
def test_each_changed_bit_is_noticed(stream: bool, number: int, signed: bool) -> None:
    data = build(3, number, flags=int(signed), tail=bytes(13) if signed else b"")
    for bit in range(8, 8 * len(data[:15])):  # up to the end of the checksum
        damaged = bytearray(data)
        damaged[bit // 8] ^= 1 << bit % 8
        framer = Framer(stream=stream)
        assert framer.feed(bytes(damaged), 0.0) + framer.expire(1.0) == [], bit
