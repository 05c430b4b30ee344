"""What is left of a hint where the line is too short for it."""

from __future__ import annotations

import pytest

from groundstation.ui.base.question import Question
from groundstation.ui.widgets.alert import fit_hint

BACK = "ESC goes back to Drive, the only screen where keys drive"


@pytest.mark.parametrize(
    ("text", "width", "fitted"),
    [
        ("D downloads · nothing is deleted", 40, "D downloads · nothing is deleted"),
        (f"D downloads · nothing is deleted · {BACK}", 50, "D downloads · nothing is deleted"),
        ("↑ ↓ choose · letters find · ENTER keeps it, ESC leaves it", 44, "↑ ↓ choose · letters find · ENTER keeps it"),
        ("↑ ↓ choose · letters find · ENTER keeps it, ESC leaves it", 30, "↑ ↓ choose · ENTER keeps it"),
        ("refused: item 8: INVALID_PARAM5_X · U uploads it again", 40, "refused: item 8: I… · U uploads it again"),
        ("one part that is too long", 10, "one part …"),
        ("a · b", 0, ""),
    ],
)
def test_the_end_of_a_hint_says_what_to_press(text: str, width: int, fitted: str) -> None:
    assert fit_hint(text, width) == fitted
    assert len(fitted) <= width


@pytest.mark.parametrize("width", [30, 77, 137])
def test_the_answer_of_a_question_is_shown_at_any_width(width: int) -> None:
    asked = Question(
        lambda: "write 12 changes to the vehicle, which is ARMED (care: FS_GCS_ENABLE, FS_ACTION)", lambda: None
    )
    assert " · y does it" in fit_hint(asked.hint, width)
    typed = Question(lambda: "erase all 120 logs on Rover 1, which cannot be undone", lambda: None, "erase", typed="er")
    assert fit_hint(typed.hint, width).endswith(" · type erase: er_")
