"""A file from pieces: what is missing, and what is requested next."""

from __future__ import annotations

from hypothesis import given
from hypothesis import strategies as st

from link.services.ftp.reassembly import FileReassembly, RangeSet


@given(st.lists(st.tuples(st.integers(0, 60), st.integers(0, 12)), max_size=30))
def test_coverage_is_a_set_of_bytes(ranges: list[tuple[int, int]]) -> None:
    coverage, model = RangeSet(), set[int]()
    for start, length in ranges:
        coverage.add(start, start + length)
        model |= set(range(start, start + length))
    gaps = {byte for start, end in coverage.gaps(80) for byte in range(start, end)}
    assert gaps == set(range(80)) - model
    assert coverage.bytes == len(model)
    assert coverage.end == max(model, default=-1) + 1


def test_a_piece_beyond_the_end_takes_no_memory() -> None:
    file = FileReassembly(1000)
    file.add_piece(990, bytes(20))
    file.add_piece(2_000_000_000, b"x")
    assert (file.received.end, file.data) == (0, b"")


def test_pieces_under_way_are_not_asked_for_twice() -> None:
    file = FileReassembly(1000)
    file.add_piece(200, bytes(300))
    assert file.next_missing(4, 100) == [(0, 100), (100, 100), (500, 100), (600, 100)]
    file.mark_requested(7, 0, due=1.0)
    assert file.next_missing(2, 100) == [(100, 100)]
    assert not file.expire_requests(0.9)
    assert file.expire_requests(1.0)
    assert file.next_missing(2, 100) == [(0, 100), (100, 100)]
    assert file.pop_request(7) is None
