"""The file of saved parameters: every value exactly, and any damage is detected."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from vehicle.params import PARAMETERS
from vehicle.storage.checksummed_file import CorruptFileError
from vehicle.storage.param_store import decode, encode

NUMBERS = st.dictionaries(st.sampled_from(sorted(PARAMETERS)), st.floats(allow_nan=False, allow_infinity=False))


@given(NUMBERS)
def test_what_is_written_is_read_to_the_last_digit(values: dict[str, float]) -> None:
    assert decode(encode(values)) == values


@given(NUMBERS, st.data())
def test_half_a_file_is_damaged(values: dict[str, float], data: st.DataObject) -> None:
    whole = encode(values)
    with pytest.raises(CorruptFileError):
        decode(whole[: data.draw(st.integers(0, len(whole) - 1))])


@given(NUMBERS, st.data())
def test_a_flipped_bit_is_damage(values: dict[str, float], data: st.DataObject) -> None:
    whole = bytearray(encode(values))
    whole[data.draw(st.integers(0, len(whole) - 1))] ^= 1 << data.draw(st.integers(0, 7))
    with pytest.raises(CorruptFileError):
        decode(bytes(whole))


@given(st.binary())
def test_any_bytes_are_values_or_damage(data: bytes) -> None:
    with pytest.raises(CorruptFileError):
        decode(data)
