"""Where the pane of a lesson is docked, and what room it leaves to the screen."""

from __future__ import annotations

from enum import Enum


class PanePlace(Enum):
    """Where the pane is."""

    RIGHT = "right"
    BELOW = "below"
    HIDDEN = "hidden"


RIGHT_FROM, BELOW_FROM = (120, 30), (80, 24)
"""Columns and rows from which the pane is at the right, and below. In a smaller terminal it is hidden."""
WIDTH, HEIGHT = 40, 6
"""Columns of the pane at the right, rows of the one below."""

Size = tuple[int, int]


def choose_place(size: Size) -> PanePlace:
    """Return the place of the pane in a terminal of this size."""
    if size[0] >= RIGHT_FROM[0] and size[1] >= RIGHT_FROM[1]:
        return PanePlace.RIGHT
    return PanePlace.BELOW if size[0] >= BELOW_FROM[0] and size[1] >= BELOW_FROM[1] else PanePlace.HIDDEN


def room_beside(size: Size, place: PanePlace) -> Size:
    """Return the columns and rows that are left to the screen."""
    columns, rows = size
    if place is PanePlace.RIGHT:
        return columns - WIDTH, rows
    return (columns, rows - HEIGHT) if place is PanePlace.BELOW else (columns, rows)
