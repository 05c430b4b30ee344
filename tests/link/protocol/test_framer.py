"""Bytes to frames: noise, cuts, forgeries and foreign dialects cost what they must and no more."""

from __future__ import annotations

import random

import pytest
from hypothesis import given
from hypothesis import strategies as st

from dialects import rover
from dialects.codec import CRC_EXTRA
from dialects.messages import Attitude, Heartbeat, ManualControl
from link.protocol.failed_frame import MAX_MISMATCHES
from link.protocol.frame import MAX_UNKNOWN, FramerCounts, payload_of
from link.protocol.framer import PARTIAL_DEADLINE, Framer
from tests.link.frames import demand, frame, heartbeat, version_1

TRAIN = b"".join(demand(number) for number in range(40))
BOTH = pytest.mark.parametrize("stream", [True, False], ids=["stream", "datagram"])


def sequences(framer: Framer, *pieces: bytes, now: float = 0.0) -> list[int]:
    return [sequence for piece in pieces for _, _, _, sequence, _ in framer.feed(piece, now)]


@BOTH
@pytest.mark.parametrize("noise", [b"\xfd", b"\xfe", b"\xfd\xfe\xfd", b"\x00AT\r", b"\xfd" * 12])
def test_noise_in_front_costs_no_frame(noise: bytes, stream: bool) -> None:
    framer = Framer(stream=stream)
    assert sequences(framer, noise + TRAIN) == list(range(40))
    assert framer.counts.resync_bytes == len(noise)


def test_pymavlink_loses_a_dozen_to_the_same_byte() -> None:
    # The reason why the framer is ours; should pymavlink mend it, this test says so.
    parser = rover.MAVLink(None)
    parser.robust_parsing = True
    messages = parser.parse_buffer(b"\xfd" + TRAIN) or []
    assert sum(each.get_type() == "MANUAL_CONTROL" for each in messages) < 30


def test_frames_arrive_byte_by_byte() -> None:
    framer = Framer(stream=True)
    assert sequences(framer, *(TRAIN[at : at + 1] for at in range(len(TRAIN)))) == list(range(40))


@BOTH
def test_a_corrupt_length_costs_only_its_frame(stream: bool) -> None:
    data = bytearray(TRAIN)
    data[23 * 10 + 1] = 200
    assert sequences(Framer(stream=stream), bytes(data)) == [each for each in range(40) if each != 10]


@BOTH
def test_a_wrong_checksum_costs_only_its_frame(stream: bool) -> None:
    data = bytearray(TRAIN)
    data[23 * 10 + 12] ^= 1
    framer = Framer(stream=stream)
    assert sequences(framer, bytes(data)) == [each for each in range(40) if each != 10]
    assert framer.counts.crc_errors == 1


def test_fifty_frames_in_one_datagram_come_in_order() -> None:
    data = b"".join(demand(number) for number in range(50))
    assert sequences(Framer(stream=False), data) == list(range(50))


def test_a_frame_over_two_datagrams_is_none() -> None:
    framer = Framer(stream=False)
    assert sequences(framer, demand(1)[:10], demand(1)[10:]) == []
    assert sequences(framer, demand(2)) == [2]


def test_a_forged_header_hides_nothing_for_long() -> None:
    # A known id, length 255, then silence: the frames behind it act after the partial deadline, not after 255 bytes.
    framer = Framer(stream=True)
    forged = bytes([0xFD, 255, 0, 0, 0, 1, 1, 69, 0, 0])
    assert sequences(framer, forged + demand(7), now=0.0) == []
    assert framer.expire(PARTIAL_DEADLINE / 2) == []
    assert [sequence for _, _, _, sequence, _ in framer.expire(PARTIAL_DEADLINE)] == [7]


def test_a_slow_but_sound_frame_is_waited_for() -> None:
    framer = Framer(stream=True)
    assert sequences(framer, demand(7)[:12], now=0.0) == []
    assert sequences(framer, demand(7)[12:], now=PARTIAL_DEADLINE * 0.9) == [7]


def test_noise_for_ever_keeps_memory_small() -> None:
    framer, source = Framer(stream=True), random.Random(1)
    for step in range(256):
        framer.feed(source.randbytes(4096), step * 0.01)
        assert len(framer._buffer) < 300
    framer.expire(10.0)
    assert framer.counts.resync_bytes > 900_000
    assert sequences(framer, demand(3), now=20.0) == [3]


@BOTH
@given(st.binary(max_size=600))
def test_no_bytes_raise_and_a_frame_behind_them_acts(stream: bool, soup: bytes) -> None:
    framer = Framer(stream=stream)
    framer.feed(soup, 0.0)
    found = framer.feed(demand(9), 1.0) + framer.expire(2.0)
    assert 9 in [sequence for _, _, _, sequence, _ in found]


def test_unknown_ids_are_dropped_and_counted() -> None:
    unknown = bytearray(demand(0))
    unknown[7:10] = (45999).to_bytes(3, "little")
    for stream, data in (
        (False, bytes(unknown)),
        (False, bytes(unknown) + demand(1)),
        (True, bytes(unknown) * 3 + demand(1)),
    ):
        framer = Framer(stream=stream)
        framer.feed(data, 0.0)
        assert framer.counts.unknown == (3 if stream else 1)
        assert not framer.counts.mismatches


def test_another_dialects_checksum_is_noticed() -> None:
    foreign = bytearray(heartbeat(0))
    foreign[-1] ^= 0x55
    framer = Framer(stream=False)
    framer.feed(bytes(foreign), 0.0)
    assert framer.counts.mismatches == {Heartbeat.id: 1}
    framer.feed(b"\xfd" + TRAIN, 0.0)  # noise is not a dialect
    assert framer.counts.mismatches == {Heartbeat.id: 1}


def test_flags_we_may_not_ignore_are_refused() -> None:
    data = bytearray(demand(0))
    data[2] = 0x02
    framer = Framer(stream=False)
    assert framer.feed(bytes(data), 0.0) == []
    assert framer.counts.refused == 1


def test_a_signed_frame_is_taken_whole_and_a_cut_signature_waits() -> None:
    from fastcrc.crc16 import mcrf4xx

    body = bytearray(demand(5)[1:-2])
    body[1] = 1
    signed = b"\xfd" + bytes(body) + mcrf4xx(bytes(body) + b"\xf3").to_bytes(2, "little") + bytes(13)
    assert sequences(Framer(stream=False), signed + demand(6)) == [5, 6]
    assert sequences(Framer(stream=False), signed[:-1]) == []
    framer = Framer(stream=True)
    assert sequences(framer, signed[:-1]) == []
    assert sequences(framer, signed[-1:]) == [5]


def test_mavlink_1_needs_its_full_length() -> None:
    beat = Heartbeat(6, 8, 0, 0, 4, 3)
    assert sequences(Framer(stream=True), version_1(beat, 3)) == [3]
    framer = Framer(stream=True)
    assert sequences(framer, version_1(beat, 3, cut=2), demand(4)) == [4]
    assert framer.counts.refused >= 1


def test_payload_and_sender_are_told() -> None:
    sent = frame(Attitude(1, 0.5, 0, 0, 0, 0, 0), 8, 2, 3)
    assert Framer(stream=False).feed(sent, 0.0) == [(Attitude.id, 2, 3, 8, sent)]
    assert payload_of(sent) == sent[10:-2]
    [(*_, old)] = Framer(stream=False).feed(version_1(Heartbeat(6, 8, 0, 0, 4, 3)), 0.0)
    assert len(payload_of(old)) == 9
    assert ManualControl.id == 69


@pytest.mark.parametrize("data", [b"", b"\xfd", b"\xfe" * 3, bytes(65507)])
def test_empty_short_and_huge_datagrams(data: bytes) -> None:
    framer = Framer(stream=False)
    assert framer.feed(data, 0.0) == []
    assert framer.counts.resync_bytes == len(data)


@pytest.mark.parametrize("router", [False, True])
@pytest.mark.parametrize("number", [Heartbeat.id, 61000])
def test_datagram_shorter_than_signature_is_no_frame_or_unknown(number: int, router: bool) -> None:
    """A frame of 12 to 14 bytes with a bad checksum ended the program: its signature was looked for."""
    for length in (0, 1, 2):
        data = bytes([0xFD, length, 0, 0, 7, 1, 1, number & 255, number >> 8, 0, *(5,) * length, 1, 2])
        found = Framer(stream=False, unknown=router).feed(data, 0.0)
        assert [raw for *_, raw in found] == ([data] if router and number == 61000 else [])


# ---- for routers: ids that nobody here knows ----


def unknown(sequence: int) -> bytes:
    """A frame of an id outside the dialect; its checksum says nothing to us."""
    data = bytearray(demand(sequence))
    data[7:10] = (45999).to_bytes(3, "little")
    return bytes(data)


@BOTH
def test_a_router_gets_unknown_frames_between_sound_ones(stream: bool) -> None:
    framer = Framer(stream=stream, unknown=True)
    train = demand(1) + unknown(2) + unknown(3) + demand(4) + unknown(5)
    assert sequences(framer, train) == [1, 2, 3, 4, 5]
    assert (framer.counts.frames, framer.counts.unknown, framer.counts.resync_bytes) == (2, 3, 0)


def test_in_noise_an_unknown_id_hides_and_delays_nothing() -> None:
    # 0xFD in noise claims an id that nobody knows nearly always: it must not be waited for.
    framer = Framer(stream=True, unknown=True)
    claim = bytes([0xFD, 200, 0, 0, 9, 9, 9, 9, 9, 9])
    assert sequences(framer, b"noise" + claim + demand(7)) == [7]
    assert sequences(framer, unknown(8)) == [8]
    assert framer.counts.unknown == 1


def test_an_unknown_frame_that_does_not_end_at_another_is_none() -> None:
    framer = Framer(stream=False, unknown=True)
    assert sequences(framer, unknown(1) + b"rest") == []
    assert sequences(framer, unknown(1)[:-1]) == []
    assert framer.counts.unknown == 0


# ---- frames of ids that the dialect lacks ----


def foreign(sequence: int, payload: bytes, *, old: bool = False) -> bytes:
    """A sound frame of an unknown id, MAVLink 2, or `old`: MAVLink 1."""
    if old:
        return bytes([0xFE, len(payload), sequence, 1, 1, 213]) + payload + b"\x12\x34"
    return bytes([0xFD, len(payload), 0, 0, sequence, 1, 1, 0xAF, 0xB3, 0]) + payload + b"\x12\x34"


INSIDE = (
    b"",
    bytes([0xFD, 3, 0, 0, 1, 1, 1, 0, 0, 0, 9, 9, 9, 1, 2]),  # HEARTBEAT of a wrong checksum
    bytes([0xFE, 9, 1, 1, 1, 0, *range(9), 1, 2]),  # the same in MAVLink 1
    bytes([0xFE, 3, 1, 1, 1, 0, 1, 2, 3, 4, 5]),  # a MAVLink 1 HEARTBEAT of a wrong length
    bytes([0xFD, 3, 0x80, 0, 1, 1, 1, 0, 0, 0, 9, 9, 9, 1, 2]),  # flags that nobody knows
    bytes([0xFE, 2, 1, 1, 1, 213, 7, 7, 7, 7]),  # one unknown frame inside another
)


@pytest.mark.parametrize("old", [False, True])
@pytest.mark.parametrize("piece", [1, 7, 1000])
def test_a_sound_frame_of_an_unknown_id_is_no_damage(old: bool, piece: int) -> None:
    """Whatever its payload looks like: "bad" frames on a clean TCP link were bytes of other dialects' messages."""
    framer = Framer(stream=True)
    train = b"".join(foreign(number, inside + b"xx", old=old) + demand(number) for number, inside in enumerate(INSIDE))
    found = [each for start in range(0, len(train), piece) for each in framer.feed(train[start : start + piece], 0.0)]
    assert len(found) == len(INSIDE)
    counts = framer.counts
    assert (counts.unknown, counts.crc_errors, counts.refused, counts.resync_bytes) == (len(INSIDE), 0, 0, 0)
    number = 213 if old else 0xB3AF
    assert counts.unknown_ids == {(1, 1, number): (len(INSIDE), len(foreign(0, INSIDE[-1] + b"xx", old=old)))}


def test_unknown_ids_are_counted_by_their_source_up_to_a_bound() -> None:
    framer = Framer(stream=False)
    for number in range(2 * MAX_UNKNOWN):
        for size in (3, 5):
            body = bytes([0xFD, size, 0, 0, 0, 7, 1, number, 0xFF, 0xFF]) + bytes(size)
            framer.feed(body + b"\x12\x34", 0.0)
    counts = FramerCounts()
    counts.add(framer.counts)
    counts.add(framer.counts)
    assert len(counts.unknown_ids) == MAX_UNKNOWN
    assert counts.unknown_ids[7, 1, 0xFFFF00] == (4, 17)
    assert counts.unknown == 8 * MAX_UNKNOWN


def test_damage_inside_what_was_no_frame_still_counts() -> None:
    framer = Framer(stream=True)
    stray = foreign(1, INSIDE[1] + INSIDE[3] + b"xx")[:-1]  # a byte is lost: it does not end where the next one begins
    assert sequences(framer, stray + demand(2) + demand(3)) == [2, 3]
    assert (framer.counts.unknown, framer.counts.crc_errors, framer.counts.refused) == (0, 1, 1)
    assert framer.counts.resync_bytes == len(stray)


@given(st.lists(st.tuples(st.binary(max_size=60), st.booleans()), max_size=12), st.integers(1, 200))
def test_any_unknown_frames_between_sound_ones(train: list[tuple[bytes, bool]], piece: int) -> None:
    framer = Framer(stream=True)
    data = b"".join(foreign(n, payload, old=old) + demand(n) for n, (payload, old) in enumerate(train))
    found = [each for start in range(0, len(data), piece) for each in framer.feed(data[start : start + piece], 0.0)]
    found += framer.expire(1.0)
    assert len(found) == len(train)


def test_of_too_many_foreign_definitions_the_first_are_counted() -> None:
    framer = Framer(stream=False)
    ids = [number for number in sorted(CRC_EXTRA) if number not in (0, 69)][: MAX_MISMATCHES + 1]
    for number in ids:
        foreign = bytearray(frame(Heartbeat(6, 8, 0, 0, 4, 3)))
        foreign[7:10] = number.to_bytes(3, "little")
        foreign[-1] ^= 0x55
        framer.feed(bytes(foreign), 0.0)
    assert len(framer.counts.mismatches) == MAX_MISMATCHES
    assert ids[-1] not in framer.counts.mismatches


def test_what_only_looks_like_a_header_is_no_frame_for_a_router() -> None:
    framer = Framer(stream=False, unknown=True)
    flags = unknown(2)[:2] + b"\x7e" + unknown(2)[3:]
    assert sequences(framer, demand(1) + flags + demand(3)) == [1, 3]
