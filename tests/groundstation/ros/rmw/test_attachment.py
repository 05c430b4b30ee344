"""The attachment of a message, and ids made of tokens."""

from __future__ import annotations

import pytest

from groundstation.ros.rmw.attachment import Attachment, decode, gid_of


def test_its_bytes_are_those_that_the_design_of_rmw_zenoh_lists() -> None:
    made = Attachment(1, 2, bytes(range(16))).encode()
    assert made == b"\x01" + 7 * b"\x00" + b"\x02" + 7 * b"\x00" + b"\x10" + bytes(range(16))
    assert decode(made) == Attachment(1, 2, bytes(range(16)))


@pytest.mark.parametrize(
    "data", [b"", b"\x00" * 32, b"\x00" * 33, b"\xff" * 33, Attachment(1, 2, bytes(16)).encode() + b"\x00"]
)
def test_other_bytes_are_none(data: bytes) -> None:
    assert decode(data) is None


def test_the_id_is_the_low_then_the_high_half_of_xxh3() -> None:
    # https://github.com/Cyan4973/xxHash: XXH3_128bits of no bytes is 99aa06d3014798d86001c324468d497f.
    assert gid_of("") == bytes.fromhex("99aa06d3014798d86001c324468d497f")[::-1]
    assert len({gid_of("a"), gid_of("b"), gid_of("a" * 300)}) == 3
