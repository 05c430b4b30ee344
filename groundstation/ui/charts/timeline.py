"""ChartTimeline: modes as bars, events and own keys as marks, and the times under the charts."""

from __future__ import annotations

from collections.abc import Iterable

import msgspec
from rich.style import Style
from textual.strip import Strip

from groundstation.ui.charts.pane import AXIS
from groundstation.ui.display.wrap import clean
from groundstation.ui.look.colours import AMBER, BLUE, DIM, GREEN, LINE, RED, TEXT, WHITE, YELLOW, style
from groundstation.ui.widgets.canvas import Canvas
from groundstation.ui.widgets.instrument import Instrument, strip

MODE_COLOURS = {"MANUAL": GREEN, "HOLD": AMBER}
"""Mode -> its colour; those that move by themselves are yellow."""

_EVENTS = {"armed": ("▲", RED), "disarmed": ("▼", GREEN), "failsafe": ("!", RED), "link": ("!", AMBER)}
"""Kind of mark -> sign and colour; its text stands behind it where there is room."""

KEY_NAMES = {
    "space": "␣",
    "stop": "␣",
    "full_stop": ".",
    "comma": ",",
    "left": "←",
    "right": "→",
    "up": "↑",
    "down": "↓",
}
"""Keys with names -> what is printed."""

TIME_GAP = 6
"""Cells between two times, at least."""

HEADER, ROWS = 4, 3
"""Rows from which on there is a header, and rows without it."""


class TimelineMode(msgspec.Struct, frozen=True):
    """A mode, from one column of dots to another, counted from the left edge."""

    first: int
    end: int
    name: str


class TimelineMark(msgspec.Struct, frozen=True):
    """An event or a key at a column of dots."""

    column: int
    kind: str
    text: str


class ChartTimelineValue(msgspec.Struct, frozen=True):
    """What happened in the window."""

    dots: int = 2
    modes: tuple[TimelineMode, ...] = ()
    marks: tuple[TimelineMark, ...] = ()
    begin: str = ""
    end: str = ""
    """Time of day at the edges."""
    cursor: int | None = None
    cursor_time: str = ""
    between: tuple[str, ...] = ()
    """Times at equal steps between those at the edges."""


class ChartTimeline(Instrument[ChartTimelineValue]):
    """Three rows: modes, marks, time; with a header where there is room."""

    def draw(self, width: int, height: int) -> list[Strip]:
        """Draw them."""
        canvas = Canvas(width, ROWS)
        for row, name in enumerate(("modes", "marks", "time")):
            canvas.write(1, row, name, style(DIM))
        for mode in self.value.modes:
            _draw_mode(canvas, mode)
        _draw_marks(canvas, self.value.marks, width)
        _draw_times(canvas, self.value, width)
        header = strip(
            ("─ ", style(LINE)), ("events", style(BLUE)), (" " + "─" * max(0, width - 10) + "─", style(LINE))
        )
        return [*([header] if height >= HEADER else []), *canvas.strips()][:height]


def _draw_mode(canvas: Canvas, mode: TimelineMode) -> None:
    first, end = AXIS + mode.first // 2, AXIS + (mode.end + 1) // 2
    look = style(MODE_COLOURS.get(mode.name, YELLOW))
    name = f" {clean(mode.name)} "
    bar = "━" * (end - first)
    if len(name) + 2 <= len(bar):
        bar = f"━━{name}{'━' * (len(bar) - len(name) - 2)}" if len(bar) >= len(name) + 2 else bar
    canvas.write(first, 0, bar, look)


def _draw_marks(canvas: Canvas, marks: Iterable[TimelineMark], width: int) -> None:
    """Draw the signs of events, then keys, then the texts of events, each where there is room."""
    marks, free = list(marks), [True] * width
    events = [mark for mark in marks if mark.kind != "key"]
    for mark in (*events, *(mark for mark in marks if mark.kind == "key")):
        sign, look = _sign(mark)
        _write_free(canvas, free, AXIS + mark.column // 2, sign, look)
    for mark in events:
        _write_free(canvas, free, AXIS + mark.column // 2 + 1, f" {clean(mark.text)}", _sign(mark)[1])


def _write_free(canvas: Canvas, free: list[bool], at: int, text: str, look: Style) -> None:
    """Write a text on the row of marks if nothing stands there."""
    if at + len(text) <= len(free) and all(free[at : at + len(text)]):
        canvas.write(at, 1, text, look)
        free[at : at + len(text)] = [False] * len(text)


def _sign(mark: TimelineMark) -> tuple[str, Style]:
    if mark.kind == "key":
        stops = mark.text in ("stop", "e-stop")
        return KEY_NAMES.get(mark.text, clean(mark.text)), style(RED if stops else TEXT)
    sign, colour = _EVENTS.get(mark.kind, ("!", AMBER))
    return sign, style(colour, bold=True)


def _draw_times(canvas: Canvas, value: ChartTimelineValue, width: int) -> None:
    """Draw the time of the cursor, and those at the edges where there is room beside it."""
    size = len(value.cursor_time)
    at = AXIS + (value.cursor or 0) // 2 - size // 2
    at = max(AXIS, min(at, width - size))
    if value.cursor is not None:
        canvas.write(at, 2, value.cursor_time, style(WHITE, bold=True))
    steps = len(value.between) + 1
    last = width - len(value.end)
    for number, text in enumerate((value.begin, *value.between, value.end)):
        edge = AXIS + round((last - AXIS) * number / steps)
        if last - AXIS < steps * (len(text) + TIME_GAP) and 0 < number < steps:
            continue
        if value.cursor is None or edge + len(text) < at or edge > at + size:
            canvas.write(edge, 2, text, style(DIM))
