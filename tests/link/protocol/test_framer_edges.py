"""Edges of the framer: cut frames, the deadline of partial frames, what damage is counted, and borders for routers."""

from __future__ import annotations

import pytest

from dialects.codec import CRC_EXTRA
from dialects.messages import Heartbeat, MissionCount, MissionRequestList
from link.protocol.frame import FramerCounts, sum_counts
from link.protocol.framer import PARTIAL_DEADLINE, Framer
from tests.link.frames import demand, frame, version_1
from tests.rows import each_row

BOTH = pytest.mark.parametrize("stream", [True, False], ids=["stream", "datagram"])
FORGED = bytes([0xFD, 255, 0, 0, 0, 1, 1, 69, 0, 0])
"""A header of a MANUAL_CONTROL that never ends."""
SHORT = frame(Heartbeat(0, 0, 0, 0, 0, 0))
"""The shortest MAVLink 2 frame of our encoder, 13 bytes."""
SHORT_OLD = version_1(MissionRequestList(1, 1), 5)
"""A MAVLink 1 frame of 10 bytes."""


def sequences(framer: Framer, *pieces: bytes, now: float = 0.0) -> list[int]:
    return [sequence for piece in pieces for _, _, _, sequence, _ in framer.feed(piece, now)]


def damaged(data: bytes) -> bytes:
    return data[:-1] + bytes([data[-1] ^ 0x55])


def unknown(inside: bytes = b"1234", *, system: int = 255, flags: int = 0, old: bool = False) -> bytes:
    """A frame of an id outside the dialect, which is what we see of another dialect."""
    if old:
        return bytes([0xFE, len(inside), 9, system, 190, 213]) + inside + b"\x12\x34"
    tail = bytes(13) if flags else b""
    return bytes([0xFD, len(inside), flags, 0, 9, system, 190, 0xAF, 0xB3, 0xEE]) + inside + b"\x12\x34" + tail


# ---- cut frames ----


@BOTH
@pytest.mark.parametrize("whole", [demand(2), SHORT, SHORT_OLD, version_1(Heartbeat(6, 8, 0, 0, 4, 3), 2)])
def test_a_frame_that_is_cut_anywhere_is_none_and_harms_none(whole: bytes, stream: bool) -> None:
    for length in range(1, len(whole)):
        for before in (b"", demand(1)):
            framer = Framer(stream=stream)
            assert len(framer.feed(before + whole[:length], 0.0)) == bool(before)
            assert framer.expire(PARTIAL_DEADLINE) == []
            assert sequences(framer, demand(3), now=1.0) == [3]
            assert framer.counts.resync_bytes == length
            assert framer.counts.frames == 1 + bool(before)


@pytest.mark.parametrize(
    "whole", [SHORT_OLD, version_1(MissionCount(1, 1, 9), 5), version_1(Heartbeat(6, 8, 0, 0, 4, 3), 5)]
)
def test_a_short_mavlink_1_frame_is_found_at_its_last_byte(whole: bytes) -> None:
    framer = Framer(stream=True)
    assert sequences(framer, whole) == [5]
    assert sequences(framer, demand(1) + whole) == [1, 5]
    assert sequences(Framer(stream=False), whole) == [5]
    assert sequences(Framer(stream=False), demand(1) + whole) == [1, 5]


@BOTH
def test_noise_is_counted_where_it_is_found(stream: bool) -> None:
    framer = Framer(stream=stream)
    for times in (1, 2):
        assert sequences(framer, demand(1) + b"ab" + demand(2) + b"cde") == [1, 2]
        assert framer.counts.resync_bytes == 5 * times


@BOTH
@pytest.mark.parametrize("length", [0, 1])
def test_the_shortest_frame_with_a_wrong_checksum_is_counted(length: int, stream: bool) -> None:
    framer = Framer(stream=stream)
    data = bytes([0xFD, length, 0, 0, 7, 1, 1, 0, 0, 0, *(1,) * length, 0, 0])
    for times in (1, 2):
        assert framer.feed(data, 0.0) == framer.expire(1.0) == []
        assert framer.counts.crc_errors == times
    framer.feed(demand(1), 2.0)
    assert framer.counts.mismatches == {Heartbeat.id: 2}


@pytest.mark.parametrize(("number", "refused", "unknown_frames"), [(0, 1, 0), (213, 0, 1)])
@BOTH
def test_an_empty_frame_of_mavlink_1_is_refused_or_unknown(
    number: int, refused: int, unknown_frames: int, stream: bool
) -> None:
    framer = Framer(stream=stream)
    framer.feed(bytes([0xFE, 0, 7, 1, 1, number, 1, 2]) + (demand(1) if stream else b""), 0.0)
    assert (framer.counts.refused, framer.counts.unknown) == (refused, unknown_frames)


@BOTH
def test_signed_frame_of_unknown_id_is_unknown_and_not_refused(stream: bool) -> None:
    framer = Framer(stream=stream)
    assert sequences(framer, unknown(flags=1) + demand(1)) == [1]
    assert (framer.counts.unknown, framer.counts.refused) == (1, 0)
    assert framer.counts.unknown_ids == {(255, 190, 0xEEB3AF): (1, len(unknown(flags=1)))}


@BOTH
def test_signed_frames_with_three_byte_id_are_found_among_others(stream: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    from fastcrc.crc16 import mcrf4xx

    monkeypatch.setitem(CRC_EXTRA, 0x012345, b"\x77")
    body = bytes([2, 1, 0, 7, 1, 2, 0x45, 0x23, 0x01, 8, 9])
    data = b"\xfd" + body + mcrf4xx(body + b"\x77").to_bytes(2, "little") + bytes(13)
    found = Framer(stream=stream).feed(demand(1) + data + data, 0.0)
    assert found[1:] == [(0x012345, 1, 2, 7, data)] * 2


# ---- the deadline of partial frames ----


@pytest.mark.parametrize("start", [0.0, 1.1, 50.0, 1234.567, 86_400.3])
def test_at_the_deadline_all_behind_a_forged_header_is_found(start: float) -> None:
    framer = Framer(stream=True)
    assert framer.feed(FORGED + FORGED + bytes(20) + FORGED + demand(7), start) == []
    assert [each[3] for each in framer.expire(start + PARTIAL_DEADLINE + 1e-6)] == [7]
    assert framer.expire(start + 1.0) == []


def test_bytes_at_the_deadline_come_behind_those_that_waited() -> None:
    framer = Framer(stream=True)
    assert framer.feed(FORGED + demand(7), 0.0) == []
    assert sequences(framer, demand(8) + demand(9), now=PARTIAL_DEADLINE) == [7, 8, 9]
    assert framer.feed(FORGED + demand(7) + demand(8)[:12], 1.0) == []
    assert sequences(framer, demand(8)[12:], now=1.2) == [7, 8]


def test_bytes_before_the_deadline_wait_with_the_others() -> None:
    framer = Framer(stream=True)
    assert framer.feed(FORGED + demand(7), 50.0) == []
    assert sequences(framer, demand(8), now=50.0 + PARTIAL_DEADLINE * 0.9) == []
    assert sequences(framer, b"", now=50.0 + PARTIAL_DEADLINE * 1.1) == [7, 8]


def test_deadline_counts_from_the_first_byte_of_the_open_frame() -> None:
    framer = Framer(stream=True)
    assert sequences(framer, demand(1)[:12], now=50.0) == []
    assert sequences(framer, demand(1)[12:] + demand(2)[:12], now=50.09) == [1]
    assert framer.expire(50.15) == []
    assert sequences(framer, demand(2)[12:], now=50.16) == [2]
    assert sequences(framer, demand(3)[:12], now=60.0) == [], "nothing has waited since the last frame"
    assert framer.expire(60.09) == []
    assert sequences(framer, demand(3)[12:], now=60.095) == [3]
    assert framer.counts.resync_bytes == 0


def test_a_frame_behind_one_given_up_has_its_own_deadline() -> None:
    framer = Framer(stream=True)
    assert framer.feed(FORGED + demand(1) + demand(2)[:12], 50.0) == []
    assert [each[3] for each in framer.expire(50.11)] == [1]
    assert framer.expire(50.2) == []
    assert sequences(framer, demand(2)[12:], now=50.205) == [2]
    assert framer.counts.resync_bytes == len(FORGED)


def test_a_partial_frame_waits_for_100_ms() -> None:
    framer = Framer(stream=True)
    framer.feed(demand(1)[:12], 0.0)
    assert framer.expire(0.099) == []
    assert framer.counts.resync_bytes == 0
    framer.expire(0.1)
    assert framer.counts.resync_bytes == 12
    assert framer.feed(demand(1)[:12], 1.0) == framer.expire(1.2) == []
    assert framer.counts.resync_bytes == 24


# ---- what damage is counted ----


def test_damage_inside_a_false_frame_is_added_to_the_count() -> None:
    wrong_length = bytes([0xFE, 3, 1, 1, 1, 0, 1, 2, 3, 4, 5])
    framer = Framer(stream=True)
    assert sequences(framer, damaged(SHORT) + wrong_length + demand(1)) == [1]
    assert (framer.counts.crc_errors, framer.counts.refused) == (1, 1)
    inside = damaged(SHORT) + damaged(SHORT) + wrong_length + wrong_length
    assert sequences(framer, unknown(inside + b"xx")[:-1] + demand(2) + demand(3)) == [2, 3]
    assert (framer.counts.crc_errors, framer.counts.refused, framer.counts.unknown) == (3, 3, 0)


@BOTH
def test_each_frame_of_another_definition_is_counted(stream: bool) -> None:
    framer = Framer(stream=stream)
    flags = SHORT[:2] + b"\x02" + SHORT[3:]
    assert sequences(framer, (damaged(SHORT) + demand(1)) * 3 + (flags + demand(2)) * 2) == [1, 1, 1, 2, 2]
    counts = framer.counts
    assert (counts.crc_errors, counts.refused, counts.mismatches) == (3, 2, {Heartbeat.id: 3})


@BOTH
def test_damage_directly_behind_an_unknown_frame_is_damage(stream: bool) -> None:
    framer = Framer(stream=stream)
    assert sequences(framer, unknown() + damaged(SHORT) + demand(1)) == [1]
    assert (framer.counts.unknown, framer.counts.crc_errors) == (1, 1)
    assert framer.counts.mismatches == {Heartbeat.id: 1}


@BOTH
def test_damage_behind_a_false_unknown_frame_is_damage(stream: bool) -> None:
    framer = Framer(stream=stream)
    assert sequences(framer, unknown() + b"rest" + damaged(SHORT) + demand(1)) == [1]
    assert (framer.counts.unknown, framer.counts.crc_errors) == (0, 1)
    assert framer.counts.mismatches == {Heartbeat.id: 1}


@BOTH
def test_of_a_damaged_frame_inside_another_both_are_counted(stream: bool) -> None:
    framer = Framer(stream=stream)
    outer = bytes([0xFD, len(SHORT), 0, 0, 1, 1, 1, 253, 0, 0]) + damaged(SHORT) + b"\x01\x02"
    assert sequences(framer, outer + demand(1)) == [1]
    assert framer.counts.crc_errors == 2
    assert framer.counts.mismatches == {253: 1}


def test_a_known_foreign_definition_counts_on_in_a_full_table() -> None:
    framer = Framer(stream=False)
    numbers = [number for number in sorted(CRC_EXTRA) if number < 256][:70]
    for _ in range(2):
        for number in numbers:
            framer.feed(damaged(SHORT[:7] + bytes([number]) + SHORT[8:]), 0.0)
    counted = [number for number in numbers if number != Heartbeat.id][:64]
    assert set(framer.counts.mismatches.values()) == {2}
    assert len(framer.counts.mismatches) == 64
    assert set(counted) - {numbers[64]} <= {Heartbeat.id, *framer.counts.mismatches}


def test_mismatches_and_unknown_ids_are_summed() -> None:
    one = FramerCounts(mismatches={0: 2, 69: 1}, unknown_ids={(1, 1, 900): (3, 20)})
    total = sum_counts([one, one, FramerCounts()])
    assert total.mismatches == {0: 4, 69: 2}
    assert total.unknown_ids == {(1, 1, 900): (6, 20)}


def test_claim_with_a_given_up_header_inside_is_no_unknown_frame() -> None:
    """Also if a frame begins one byte behind its end, where the end would be if the byte given up were not counted."""
    framer = Framer(stream=True)
    assert sequences(framer, unknown(FORGED + b"xx") + b"z" + demand(1)) == []
    assert [each[3] for each in framer.expire(PARTIAL_DEADLINE)] == [1]
    assert (framer.counts.unknown, framer.counts.resync_bytes) == (0, len(unknown(FORGED + b"xx")) + 1)


# ---- for routers ----


def test_a_router_gets_an_unknown_frame_of_mavlink_1() -> None:
    framer = Framer(stream=True, unknown=True)
    assert sequences(framer, demand(1) + unknown(old=True) + demand(2)) == [1, 9, 2]
    assert framer.counts.unknown == 1


@BOTH
def test_a_router_gets_no_unknown_frame_of_system_0(stream: bool) -> None:
    assert sequences(Framer(stream=stream, unknown=True), demand(1) + unknown(system=0) + demand(2)) == [1, 2]


@pytest.mark.parametrize("noise", [b"noise", b"n"])
def test_for_a_router_no_unknown_frame_begins_behind_noise(noise: bytes) -> None:
    for pieces in (
        (noise, unknown() + demand(1)),
        (noise + unknown() + demand(1),),
        (noise, b"x" + unknown() + demand(1)),
    ):
        framer = Framer(stream=True, unknown=True)
        assert sequences(framer, *pieces) == [1]
        assert sequences(framer, unknown() + demand(2)) == [9, 2]


def test_a_router_finds_no_unknown_frame_inside_one_given_up() -> None:
    inner = bytes([0xFD, 0, 0, 0, 9, 255, 69, 0, 0, 0xEE, 0x12, 0x34])  # behind 0xFD a header of a MANUAL_CONTROL
    framer = Framer(stream=True, unknown=True)
    assert sequences(framer, b"\xfd" + inner + demand(1)) == []
    assert [each[3] for each in framer.expire(PARTIAL_DEADLINE)] == [1]


@BOTH
@pytest.mark.parametrize("flags", [0, 1])
def test_a_router_gets_a_lone_unknown_frame(flags: int, stream: bool) -> None:
    framer = Framer(stream=stream, unknown=True)
    assert [raw for *_, raw in framer.feed(unknown(flags=flags), 0.0)] == [unknown(flags=flags)]
    assert (framer.counts.frames, framer.counts.unknown) == (0, 1)


@each_row("size", range(1, 25))
def test_a_router_gets_the_same_frames_in_pieces_of_any_size(size: int) -> None:
    train = b"".join(
        (demand(1), unknown(), unknown(b""), SHORT_OLD, unknown(old=True), demand(2), unknown(flags=1), SHORT)
    )
    framer = Framer(stream=True, unknown=True)
    found = [each for at in range(0, len(train), size) for each in framer.feed(train[at : at + size], 0.0)]
    assert b"".join(raw for *_, raw in found) == train
    assert (framer.counts.frames, framer.counts.unknown, framer.counts.resync_bytes) == (4, 4, 0)
    assert framer.counts.unknown_ids == {}


@BOTH
def test_damage_of_mavlink_1_is_counted(stream: bool) -> None:
    framer = Framer(stream=stream)
    old = version_1(Heartbeat(6, 8, 0, 0, 4, 3))
    assert sequences(framer, (damaged(old) + demand(1)) * 2) == [1, 1]
    assert (framer.counts.crc_errors, framer.counts.mismatches) == (2, {Heartbeat.id: 2})
