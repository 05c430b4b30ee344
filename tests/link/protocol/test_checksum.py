"""The short form of the checksum's comparison: equal to the definition for every frame, right or damaged."""

from __future__ import annotations

from fastcrc.crc16 import mcrf4xx
from hypothesis import example, given
from hypothesis import strategies as st

from link.protocol.checksum import START, STEP, TWO_STEPS

BYTE = st.integers(0, 255)


def is_right(frame: bytes, extra: int) -> bool:
    low, high = frame[-2], frame[-1]
    return mcrf4xx(frame, START) == high ^ STEP[low ^ high] ^ TWO_STEPS[low ^ extra]


@given(st.binary(min_size=9, max_size=264), BYTE)
def test_every_right_frame_is_right(body: bytes, extra: int) -> None:
    checksum = mcrf4xx(body + bytes([extra]))
    assert is_right(b"\xfd" + body + checksum.to_bytes(2, "little"), extra)


@given(st.binary(min_size=9, max_size=264), BYTE, st.integers(0, 0xFFFF))
@example(bytes(9), 0, 0)
def test_every_other_checksum_is_wrong(body: bytes, extra: int, claimed: int) -> None:
    right = mcrf4xx(body + bytes([extra])) == claimed
    assert is_right(b"\xfd" + body + claimed.to_bytes(2, "little"), extra) == right


def test_of_all_checksums_one_is_right() -> None:
    body = bytes(range(20))
    right = [value for value in range(0x10000) if is_right(b"\xfd" + body + value.to_bytes(2, "little"), 50)]
    assert right == [mcrf4xx(body + b"\x32")]
