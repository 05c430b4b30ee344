"""ReplayTimeline: modes, armed, demand, speed, loss, events and damage over the whole log, and the position in it."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence

import msgspec
from rich.style import Style
from textual.strip import Strip

from groundstation.ui.charts.timeline import MODE_COLOURS
from groundstation.ui.display.wrap import clean
from groundstation.ui.look.colours import AMBER, DIM, GREEN, LINE, RED, TEXT, VIOLET, WHITE, YELLOW, style
from groundstation.ui.replay.events import kind_colour
from groundstation.ui.replay.model import directions, duration_text, quality
from groundstation.ui.widgets.canvas import Canvas
from groundstation.ui.widgets.instrument import Instrument
from groundstation.views.replay import ReplaySign, ReplaySpan, ReplayView

AXIS = 10
"""Cells of the names at the left."""

MOST_SPEED_ROWS = 4
SPEEDS = (0.25, 0.5, 1, 2, 4, 8, 16, 32)
_FRACTIONS = {0.25: "¼", 0.5: "½"}
_SIGNS = {"ITEM": "◆", "LINK": "!", "CLOCK": "!", "DAMAG": "!", "FAIL": "■", "TEXT": "!", "ACK": "!"}

FULL, MIDDLE = 13, 8
"""Rows from which on all is shown, and most of it."""
HOLD = 4
"""Columns over which a speed is held."""
BELOW_BAR = 4
"""Rows below the bar, where all is shown."""
HOUR = 3600
TICK_STEPS = (1, 2, 5, 10, 15, 20, 30, 60, 120, 300, 600, 900, 1200, 1800, HOUR, 2 * HOUR, 6 * HOUR, 12 * HOUR)
"""s between two times of the axis."""
TICK_CELLS = 16
"""Least cells between two of them."""


class TimelineValue(msgspec.Struct, frozen=True):
    """The view, and which characters the terminal has."""

    view: ReplayView | None = None
    ascii: bool = False


class _Sheet(msgspec.Struct):
    """A canvas with a scale."""

    canvas: Canvas
    view: ReplayView
    row: int = 0

    @property
    def columns(self) -> int:
        return max(1, self.canvas.width - AXIS)

    def at(self, time: float) -> int:
        """Return the cell of a time."""
        share = time / self.view.duration if self.view.duration > 0 else 0.0
        return AXIS + max(0, min(self.columns - 1, int(share * self.columns)))

    def name(self, text: str) -> None:
        """Write the name of a row."""
        self.canvas.write(1, self.row, text, style(DIM))


class ReplayTimeline(Instrument[TimelineValue]):
    """As many rows as fit, the most important ones in any case."""

    def draw(self, width: int, height: int) -> list[Strip]:
        """Draw them, and the position over all."""
        view, canvas = self.value.view, Canvas(width, height)
        if view is None or width <= AXIS:
            return canvas.strips()
        sheet = _Sheet(canvas, view)
        for row in range(height if height < FULL else height - BELOW_BAR):
            canvas.write(sheet.at(view.position), row, "│", style(WHITE))
        for draw_row, count in _rows(height):
            draw_row(sheet, count)
            sheet.row += count
        return canvas.strips()


def _rows(height: int) -> list[tuple[Callable[[_Sheet, int], None], int]]:
    """Return what to draw, and its rows."""
    if height >= FULL:
        speed = min(MOST_SPEED_ROWS, height - FULL + 2)
        rows = [
            (_modes, 1),
            (_armed, 1),
            (_demand, 1),
            (_speed, speed),
            (_loss, 1),
            (_events, 1),
            (_damage, 1),
            (_bar, 1),
        ]
        return [*rows, (_times, 1), (_gap, 1), (_legend, 1), (_state, 1)]
    if height >= MIDDLE:
        return [(_modes, 1), (_armed, 1), (_demand, 1), (_speed, height - 6), (_events, 1), (_bar, 1), (_times, 1)]
    return [(_modes, 1), (_speed, max(0, height - 3)), (_events, 1), (_bar, 1)]


def _modes(sheet: _Sheet, count: int) -> None:
    sheet.name("mode")
    for span in sheet.view.timeline.modes:
        _draw_span(sheet, span, MODE_COLOURS.get(span.text, YELLOW))


def _armed(sheet: _Sheet, count: int) -> None:
    sheet.name("armed")
    for span in sheet.view.timeline.armed:
        _draw_span(sheet, span, RED)


def _draw_span(sheet: _Sheet, span: ReplaySpan, colour: str) -> None:
    first, end = (
        sheet.at(span.start),
        max(sheet.at(span.start) + 1, sheet.at(span.end) + (span.end >= sheet.view.duration)),
    )
    name, bar = f" {clean(span.text)} ", "━" * (end - first)
    if len(name) + 4 <= len(bar):
        bar = f"━━{name}{bar[len(name) + 2 :]}"
    sheet.canvas.write(first, sheet.row, bar, style(colour))


def _demand(sheet: _Sheet, count: int) -> None:
    sheet.name("driven")
    for column, value in enumerate(sheet.view.timeline.demand):
        if value is not None and value > 0:
            sheet.canvas.write(AXIS + column, sheet.row, "█" if value > 0.5 else "▄", style(YELLOW))


def _speed(sheet: _Sheet, count: int) -> None:
    if not count:
        return
    sheet.name("speed")
    values = sheet.view.timeline.speed
    most = max((value for value in values if value is not None), default=0.0)
    if most <= 0:
        return
    sheet.canvas.write(1, sheet.row + count - 1, f"{most:.1f} m/s" if count > 1 else "", style(DIM))
    bottom = (sheet.row + count) * 4 - 1
    for column, value in enumerate(_held(values)):
        dots = round(value / most * (count * 4))
        for x in (0, 1):
            if dots:
                sheet.canvas.run((AXIS + column) * 2 + x, bottom - dots + 1, bottom, style(GREEN))


def _held(values: Sequence[float | None]) -> Iterator[float]:
    """Yield the values; one is held over a few columns without any, as in a log with few messages."""
    last, age = 0.0, 0
    for value in values:
        last, age = (last, age + 1) if value is None else (value, 0)
        yield last if age <= HOLD else 0.0


def _loss(sheet: _Sheet, count: int) -> None:
    sheet.name("loss")
    values = sheet.view.timeline.lost
    most = max((value for value in values if value is not None), default=0.0)
    for column, value in enumerate(values):
        if value and most:
            for x in (0, 1):
                bottom = sheet.row * 4 + 3
                sheet.canvas.run((AXIS + column) * 2 + x, bottom - round(value / most * 3), bottom, style(AMBER))


def _events(sheet: _Sheet, count: int) -> None:
    sheet.name("events")
    free = [True] * sheet.canvas.width
    signs = sheet.view.timeline.signs
    for sign in signs:
        _write_free(
            sheet, free, AXIS + sign.column, _sign(sign), style(kind_colour(sign.kind, sign.severity), bold=True)
        )
    for sign in sorted(signs, key=lambda each: each.severity):
        if sign.kind not in ("ARM", "ITEM"):
            text = f" {clean(sign.text)} "
            _write_free(sheet, free, AXIS + sign.column + 1, text, style(kind_colour(sign.kind, sign.severity)))


def _sign(sign: ReplaySign) -> str:
    if sign.kind == "ARM":
        return "▲" if sign.text == "armed" else "▼"
    return _SIGNS.get(sign.kind, "!")


def _write_free(sheet: _Sheet, free: list[bool], at: int, text: str, look: Style) -> None:
    if at + len(text) <= len(free) and all(free[at : at + len(text)]):
        sheet.canvas.write(at, sheet.row, text, look)
        free[at : at + len(text)] = [False] * len(text)


def _damage(sheet: _Sheet, count: int) -> None:
    sheet.name("damaged")
    columns = [column for column, value in enumerate(sheet.view.timeline.damage) if value]
    for column in columns:
        sheet.canvas.write(AXIS + column, sheet.row, "▒", style(RED))
    if columns:
        text = f" {sheet.view.damaged} bytes left out"
        at = AXIS + columns[-1] + 1
        at = at if at + len(text) <= sheet.canvas.width else max(AXIS, AXIS + columns[0] - len(text))
        sheet.canvas.write(at, sheet.row, text, style(RED))


def _bar(sheet: _Sheet, count: int) -> None:
    view, canvas, row = sheet.view, sheet.canvas, sheet.row
    here, known = sheet.at(view.position), AXIS + round(sheet.columns * view.indexed)
    state = ("◀" if view.backwards else "▶") if view.playing else "pause"
    canvas.write(1, row, f"{state} {speed_text(view.speed)}", style(GREEN if view.playing else AMBER, bold=True))
    canvas.write(AXIS, row, "─" * sheet.columns, style(LINE))
    canvas.write(AXIS, row, "━" * (here - AXIS), style(VIOLET))
    if view.indexed < 1:
        canvas.write(max(here + 2, known), row, f" index {100 * view.indexed:.0f} % ", style(DIM))
    for name, mark in zip("AB", view.marks, strict=True):
        if mark is not None:
            canvas.write(sheet.at(mark), row, name, style(YELLOW, bold=True))
    canvas.write(here, row, "●", style(WHITE, bold=True))


def _times(sheet: _Sheet, count: int) -> None:
    view, canvas = sheet.view, sheet.canvas
    here, end = duration_text(view.position, tenths=True), duration_text(view.duration)
    at = max(AXIS, min(sheet.at(view.position) - len(here) // 2, canvas.width - len(here)))
    taken = [(at, at + len(here))]
    canvas.write(at, sheet.row, here, style(WHITE, bold=True))
    ticks = [(sheet.at(time), duration_text(time)) for time in tick_times(view.duration, sheet.columns)]
    for edge, text in [(AXIS, "0:00"), (canvas.width - len(end), end), *ticks]:
        if edge + len(text) <= canvas.width and all(edge + len(text) < a or edge > b for a, b in taken):
            canvas.write(edge, sheet.row, text, style(DIM))
            taken.append((edge, edge + len(text)))


def tick_times(duration: float, columns: int) -> list[float]:
    """Return the times of an axis, s: multiples of a step that people count in, TICK_CELLS or more apart."""
    steps = [step for step in TICK_STEPS if step * columns >= duration * TICK_CELLS]
    step = steps[0] if steps else math.ceil(duration * TICK_CELLS / columns / TICK_STEPS[-1]) * TICK_STEPS[-1]
    return [float(step * number) for number in range(1, int(duration // step) + 1)]


def _gap(sheet: _Sheet, count: int) -> None:
    """Leave a row free."""


def _legend(sheet: _Sheet, count: int) -> None:
    canvas, view, at = sheet.canvas, sheet.view, 1
    canvas.write(at, sheet.row, "speed", style(DIM))
    at += 7
    for speed in SPEEDS:
        text = f" {speed_text(speed)} "
        chosen = speed == view.speed
        canvas.write(at, sheet.row, text, style(WHITE if chosen else DIM, bold=chosen))
        at += len(text)
    first, last = ("--" if mark is None else duration_text(mark, tenths=True) for mark in view.marks)
    looping = "loops" if view.loop else "l loops"
    canvas.write(at + 3, sheet.row, f"mark A {first}  B {last}  {looping}", style(TEXT))


def _state(sheet: _Sheet, count: int) -> None:
    text, bad = quality(sheet.view)
    sheet.canvas.write(1, sheet.row, text, style(RED if bad else DIM))
    sheet.canvas.write(len(text) + 4, sheet.row, directions(sheet.view), style(DIM))


def speed_text(speed: float) -> str:
    """Return a speed as it is printed."""
    return f"{_FRACTIONS.get(speed) or f'{speed:g}'}×"
