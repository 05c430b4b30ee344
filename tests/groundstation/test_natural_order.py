"""Order of names with numbers."""

from __future__ import annotations

from hypothesis import given
from hypothesis import strategies as st

from groundstation.natural_order import natural_key


def test_numbers_in_names_count_as_numbers() -> None:
    names = [
        "BTN10_FUNCTION",
        "BTN2_FUNCTION",
        "BTN1_SFUNCTION",
        "BTN1_FUNCTION",
        "RC1_MIN",
        "RC10_MIN",
        "RC2_MIN",
    ]
    assert sorted(names, key=natural_key) == [
        "BTN1_FUNCTION", "BTN1_SFUNCTION", "BTN2_FUNCTION", "BTN10_FUNCTION", "RC1_MIN", "RC2_MIN", "RC10_MIN",
    ]  # fmt: skip


@given(st.lists(st.text()))
def test_any_names_can_be_sorted(names: list[str]) -> None:
    assert sorted(sorted(names, key=natural_key)) == sorted(names)
