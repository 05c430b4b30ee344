"""Dots and text of the canvas."""

from __future__ import annotations

from groundstation.ui.look.colours import style
from groundstation.ui.widgets.canvas import Canvas
from tests.groundstation.ui.frames import texts


def test_each_dot_of_a_cell_has_its_bit() -> None:
    seen = set()
    for x in range(2):
        for y in range(4):
            canvas = Canvas(1, 1)
            canvas.dot(x, y, style())
            seen.add(canvas.strips()[0].text)
    assert seen == {chr(0x2800 + (1 << bit)) for bit in range(8)}


def test_dots_outside_are_dropped() -> None:
    canvas = Canvas(2, 1)
    for x, y in ((-1, 0), (4, 0), (0, -1), (0, 4)):
        canvas.dot(x, y, style())
    canvas.line((-50.0, 2.0), (1e9, 2.0), style())
    canvas.write(-1, 0, "ab", style())
    assert texts(canvas.strips()) == ["b "]


def test_a_line_has_no_holes() -> None:
    canvas = Canvas(4, 1)
    canvas.line((0, 0), (7, 0), style())
    assert texts(canvas.strips()) == ["⠉⠉⠉⠉"]


def test_a_run_sets_the_dots_of_its_column_and_no_others() -> None:
    for x in range(-1, 5):
        for top in range(-3, 13):
            for bottom in range(top - 1, 15):
                runs, dots = Canvas(2, 3), Canvas(2, 3)
                runs.run(x, top, bottom, style())
                for y in range(top, bottom + 1):
                    dots.dot(x, y, style())
                assert texts(runs.strips()) == texts(dots.strips()), (x, top, bottom)
