"""Drive styles."""

from __future__ import annotations

from groundstation.input.style import Style


def test_the_next_style_wraps() -> None:
    style, seen = Style.HOLD, []
    for _ in range(3):
        style = style.next
        seen.append(style)
    assert seen == [Style.LATCH, Style.STEP, Style.HOLD]
