"""Fuzzy names."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from groundstation.station.messages.fuzzy import is_match, match_score


@pytest.mark.parametrize(
    ("query", "name"),
    [
        ("att", "ATTITUDE"), ("gpi", "GLOBAL_POSITION_INT"), ("sysvolt", "SYS_STATUS.voltage_battery"),
        ("globint", "GLOBAL_POSITION_INT"), ("status", "SYS_STATUS"), ("hud.speed", "VFR_HUD.speed"), ("", "X"),
        ("volt0", "BATTERY_STATUS.voltages[0]"),
    ],
)  # fmt: skip
def test_what_matches(query: str, name: str) -> None:
    assert is_match(query, name)


@pytest.mark.parametrize(
    ("query", "name"), [("gxi", "GLOBAL_POSITION_INT"), ("ttu", "ATTITUDE"), ("statussys", "SYS_STATUS"), ("a", "")]
)
def test_what_does_not(query: str, name: str) -> None:
    assert not is_match(query, name)


def test_words_beginning_beats_its_middle_and_part_beats_pieces() -> None:
    scores = [match_score("vol", name) for name in ("voltage", "revolt", "very_old_line")]
    known = [score for score in scores if score is not None]
    assert known == sorted(known)
    assert len(known) == 3


@given(st.text("abc_", max_size=8), st.text("abc_.", max_size=30))
def test_any_text_gives_an_answer(query: str, name: str) -> None:
    assert is_match(query, name) or query not in name
