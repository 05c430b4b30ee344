"""Heights of panels below each other."""

from __future__ import annotations

import pytest

from groundstation.ui.base.panels import PanelHeights, share_rows

SMALL = PanelHeights((3, 2, 4), (4, 3, 3))
LARGE = PanelHeights((18, 9, 5), (4, 3, 3))


@pytest.mark.parametrize(
    ("heights", "chosen", "room", "shared"),
    [
        (SMALL, 0, 41, (31, 4, 6)),
        (SMALL, 2, 41, (5, 4, 32)),
        (LARGE, 0, 20, (10, 5, 5)),
        (LARGE, 1, 20, (6, 9, 5)),
        (LARGE, 0, 15, (5, 5, 5)),
        (LARGE, 0, 14, (14, 0, 0)),
        (LARGE, 2, 6, (0, 0, 6)),
        (LARGE, 2, 0, (0, 0, 0)),
    ],
)
def test_the_chosen_panel_gets_what_the_others_leave(
    heights: PanelHeights, chosen: int, room: int, shared: tuple[int, ...]
) -> None:
    assert share_rows(heights, chosen, room) == shared
    assert sum(shared) == room
