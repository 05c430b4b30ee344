"""Logs read in pieces: what is found does not depend on the pieces, and what is lost is named."""

from __future__ import annotations

import io

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from link.tlog import tlog
from link.tlog.scan import Gap, LogFrame
from link.tlog.tlog import CHUNK, LATEST, Record, encode_record, read_log, read_records
from tests.examples import examples
from tests.link.frames import demand, heartbeat
from tests.link.routing.test_router import unknown
from tests.link.tlog.test_tlog import FRAMES, LOG, SIZE, START, version_1_heartbeat

MIXED = b"".join(
    encode_record(START + number, raw)
    for number, raw in enumerate([heartbeat(0), version_1_heartbeat(), unknown(1), demand(2), unknown(3)] * 4)
)


def in_pieces(data: bytes, size: int) -> list[LogFrame | Gap]:
    """Read a log in pieces of a size."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(tlog, "CHUNK", size)
        return [each for part in read_log(io.BytesIO(data)) for each in part]


def whole(data: bytes) -> list[LogFrame | Gap]:
    """Read a short log in one piece."""
    return in_pieces(data, CHUNK)


@settings(max_examples=examples(60))
@given(st.integers(1, 900), st.integers(0, len(MIXED)), st.binary(max_size=30), st.integers(0, 30))
def test_the_pieces_do_not_change_what_is_found(size: int, at: int, noise: bytes, cut: int) -> None:
    log = MIXED[:at] + noise + MIXED[at + cut :] + MIXED
    assert in_pieces(log, size) == whole(log)


@settings(max_examples=examples(60))
@given(st.integers(1, 900), st.integers(0, len(MIXED)), st.binary(max_size=30), st.integers(0, 30))
def test_frames_and_gaps_are_all_bytes_of_the_file(size: int, at: int, noise: bytes, cut: int) -> None:
    log = MIXED[:at] + noise + MIXED[at + cut :]
    position = 0
    for each in in_pieces(log, size):
        if isinstance(each, Gap):
            assert each.offset == position
            position += each.size
        else:
            assert each.at == position
            assert log[position + 8 : each.end] == each.raw
            position = each.end
    assert position == len(log)


@pytest.mark.parametrize("size", [100, CHUNK])
def test_a_gap_is_named_once_with_its_place(size: int) -> None:
    found = in_pieces(LOG[: SIZE * 10] + bytes(SIZE * 30) + LOG[SIZE * 40 :], size)
    assert [each for each in found if isinstance(each, Gap)] == [Gap(SIZE * 10, SIZE * 30)]
    assert [each.raw for each in found if isinstance(each, LogFrame)] == FRAMES[:10] + FRAMES[40:]


def test_an_unfinished_record_at_the_end_is_a_gap() -> None:
    assert whole(LOG[: SIZE * 10 + 20])[-1] == Gap(SIZE * 10, 20)


def test_damage_at_the_beginning_costs_no_time() -> None:
    assert next(read_records(b"damaged" + LOG)) == Record(START, FRAMES[0])


def test_a_time_that_no_clock_shows_is_that_of_the_record_before() -> None:
    log = encode_record(START, FRAMES[0]) + encode_record(LATEST + 1, FRAMES[1]) + encode_record(START + 9, FRAMES[2])
    assert [each.microseconds for each in read_records(log)] == [START, START, START + 9]


def test_a_large_file_is_read_in_small_parts() -> None:
    class Counting(io.BytesIO):
        """Notes how much is read at once."""

        most = 0

        def read(self, size: int | None = -1, /) -> bytes:
            self.most = max(self.most, 1 << 60 if size is None or size < 0 else size)
            return super().read(size)

    file = Counting(LOG * (CHUNK * 4 // len(LOG)))
    parts = list(read_log(file))
    assert sum(map(len, parts)) * SIZE == len(file.getvalue())
    assert file.most == CHUNK
    assert max(map(len, parts)) <= CHUNK // SIZE + 1
