"""Heights of panels below each other, of which one is chosen."""

from __future__ import annotations

import msgspec

BORDERS = 2
"""Rows of the border of a panel."""

LEAST_CHOSEN = 3
"""Rows that the chosen panel needs inside its border; below that the others are hidden."""


class PanelHeights(msgspec.Struct, frozen=True):
    """Rows inside the border of each panel: what it needs, and the least that it can be cut to."""

    wanted: tuple[int, ...]
    least: tuple[int, ...]


def share_rows(heights: PanelHeights, chosen: int, room: int) -> tuple[int, ...]:
    """Return the height of each panel with its border; 0: hidden. The chosen one gets what the others leave."""
    whole = tuple(rows + BORDERS for rows in heights.wanted)
    others = list(whole)
    if sum(whole) > room:
        cut = zip(heights.wanted, heights.least, strict=True)
        others = [min(wanted, least) + BORDERS for wanted, least in cut]
    others[chosen] = 0
    if room - sum(others) < LEAST_CHOSEN + BORDERS:
        others = [0] * len(others)
    others[chosen] = max(0, room - sum(others))
    return tuple(others)
