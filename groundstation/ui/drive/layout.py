"""Layouts of the Drive screen by the size of the terminal, as classes for drive.tcss.

| class | from | what it has |
|---|---|---|
| -narrow | 80x24 | a pane, the instruments, one line each of mission and stop bounds |
| -wide | 120x30 | a third column: key to motor, stop bounds, health; the mission strip over the whole width |
| -large | 180x30 | a second pane |
| -short | below 44 rows, wide | fewer lines in the third column and the mission strip |
| -chart | where its rows are | the speed chart below the instruments |
| -tall, -huge | 50, 60 rows, wide | links below health; more lines of the log |
"""

from __future__ import annotations

CONSOLE_SIZE = (80, 24)
"""Columns and rows below which the console does not fit; the driving strip takes its place."""

LOW_CONSOLE_SIZE = (80, 18)
"""The same above the pane of a lesson, whose class -low leaves out the heading tape, the log and two lines."""

MIN_STRIP_SIZE = (40, 10)
"""Columns and rows below which mode, ARMED, the bar of a held key and the first alert would not fit: nothing drives."""

WIDE, LARGE = (120, 30), (180, 30)

Size = tuple[int, int]


def is_smaller(size: Size, least: Size) -> bool:
    """Return whether a size has less columns or rows."""
    return size[0] < least[0] or size[1] < least[1]


CLASSES = ("-narrow", "-wide", "-large", "-short", "-chart", "-tall", "-huge")


def layout_classes(size: Size) -> frozenset[str]:
    """Return those of CLASSES that a size has."""
    _, rows = size
    if is_smaller(size, WIDE):
        return frozenset({"-narrow", *(("-chart",) if rows >= 30 else ())})
    chosen = {
        "-wide": True,
        "-large": not is_smaller(size, LARGE),
        "-short": rows < 44,
        "-chart": rows >= 36,
        "-tall": rows >= 50,
        "-huge": rows >= 60,
    }
    return frozenset(name for name, holds in chosen.items() if holds)
