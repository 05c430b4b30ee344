"""Both scans of a telemetry log: whole, cut, flipped, with unknown messages and with garbage."""

from __future__ import annotations

import random

import pytest

from dialects import codec
from dialects import messages as m
from link.tlog.scan import BEYOND, CarefulScan, Gap, LogFrame, id_of, key_of, scan, scan_fast
from link.tlog.tlog import encode_record

START = 1_700_000_000_000_000


def frame_of(number: int) -> bytes:
    """Return a frame: a HEARTBEAT each ten, texts between them."""
    message = m.Heartbeat(10, 3, 0, number, 4, 3) if number % 10 == 0 else m.StatusText(6, f"text {number}".encode())
    return codec.frame(type(message).id, codec.encode_payload(message), number & 0xFF, 1, 1)


def log_of(count: int) -> bytes:
    """Return a log of so many records."""
    return b"".join(encode_record(START + number * 10_000, frame_of(number)) for number in range(count))


def unknown(number: int) -> bytes:
    """Return a frame with an id that no dialect has."""
    return b"\xfd\x04\x00\x00" + bytes([number & 0xFF, 1, 1, 0x50, 0xC3, 0x00]) + b"abcd\x12\x34"


def whole(data: bytes) -> CarefulScan:
    """Scan all of it in one block."""
    return scan(data, 0, len(data), final=True)


def in_blocks(data: bytes, size: int) -> tuple[list[LogFrame], list[Gap], int]:
    """Scan it block by block, as an index does."""
    frames: list[LogFrame] = []
    damage: list[Gap] = []
    at, sure, tail = 0, True, 0
    while at + tail < len(data):
        limit = min(at + size, len(data))
        part = scan(data[at : limit + BEYOND], at, limit, final=limit + BEYOND >= len(data), sure=sure)
        frames += part.frames
        damage += part.damage
        assert part.end > at or part.tail
        at, sure, tail = part.end, part.sure, part.tail
    return frames, damage, tail


def test_a_whole_log_is_read_to_its_end() -> None:
    data = log_of(50)
    result = whole(data)
    assert [frame.raw for frame in result.frames] == [frame_of(number) for number in range(50)]
    assert [frame.stamp for frame in result.frames[:2]] == [START, START + 10_000]
    assert (result.damage, result.tail, result.end) == ([], 0, len(data))


@pytest.mark.parametrize("size", [64, 100, 1000, 100_000])
def test_blocks_of_any_size_give_the_same_frames(size: int) -> None:
    data = log_of(40) + encode_record(START, unknown(1)) + log_of(5)
    assert in_blocks(data, size)[0] == whole(data).frames
    assert len(whole(data).frames) == 46


def test_the_fast_scan_finds_the_same_records() -> None:
    data = log_of(40)
    careful = whole(data)
    fast = scan_fast(data, 0, len(data), {b"\x01\x01\x00\x00\x00"})
    assert fast is not None
    assert (fast.count, fast.end) == (40, len(data))
    assert fast.found == [frame.at for frame in careful.frames if frame.message_id == 0]
    assert fast.last == {key_of(frame): frame.at for frame in careful.frames}
    assert sorted(map(id_of, fast.last)) == [0, 253]


def test_every_byte_cut_and_flipped_names_what_is_lost() -> None:
    """What is read was written, and each byte is in a frame, in damage or in the tail."""
    data = log_of(12)
    written = {frame_of(number) for number in range(12)}
    for at in range(len(data)):
        check(data[:at], written)
        flipped = data[:at] + bytes([data[at] ^ 0xFF]) + data[at + 1 :]
        result = check(flipped, written)
        strange = any(frame.message_id not in codec.CRC_EXTRA for frame in result.frames)
        in_stamp = any(frame.at <= at < frame.at + 8 for frame in whole(data).frames)
        assert len(result.frames) == 12 if in_stamp else result.damage or result.tail or strange, at


def check(data: bytes, written: set[bytes]) -> CarefulScan:
    """Scan and account for every byte; the fast scan must give up or find what the careful one finds."""
    result = whole(data)
    assert {frame.raw for frame in result.frames if frame.message_id in codec.CRC_EXTRA} <= written
    assert sum(8 + len(frame.raw) for frame in result.frames) + sum(each.size for each in result.damage) == result.end
    assert result.end + result.tail == len(data)
    fast = scan_fast(data, 0, len(data), frozenset())
    assert fast is None or fast.end == len(data)
    return result


def test_garbage_between_records_is_one_damage() -> None:
    noise = random.Random(1).randbytes(3000)
    data = log_of(3) + noise + log_of(3)
    result = whole(data)
    assert len(result.frames) == 6
    assert result.damage == [Gap(len(log_of(3)), 3000)]
    assert sum(each.size for each in in_blocks(data, 500)[1]) == 3000


def test_a_tail_that_grows_is_read_when_it_is_whole() -> None:
    data = log_of(4)
    part = scan(data[:-5], 0, len(data) - 5, final=True)
    assert len(part.frames) == 3
    rest = scan(data[part.end :], part.end, len(data), final=True, sure=part.sure)
    assert part.frames + rest.frames == whole(data).frames


def test_noise_alone_has_no_frames() -> None:
    noise = random.Random(2).randbytes(20_000)
    assert in_blocks(noise, 4096)[0] == []
    assert scan_fast(noise, 0, len(noise), frozenset()) is None
