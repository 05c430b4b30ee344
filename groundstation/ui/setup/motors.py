"""The motor test: which key turns which motor, how strongly, and how it stands."""

from __future__ import annotations

from collections.abc import Iterator

import msgspec
from textual.strip import Strip

from groundstation.ui.display.wrap import clean, wrap
from groundstation.ui.look.colours import AMBER, DIM, GREEN, TEXT, YELLOW, style
from groundstation.ui.widgets.instrument import Instrument, Part, cropped, length, strip
from groundstation.views.doctor import DoctorView, MotorRow

BAR = 18
"""Cells of the bar of an output; its middle is neutral."""
WIDE = 60
"""Cells from which on the bar is shown beside the names."""


class MotorsValue(msgspec.Struct, frozen=True):
    """The view, and what the screen itself knows."""

    view: DoctorView | None = None
    testing: bool = False
    strength: float = 0.0


class MotorsPanel(Instrument[MotorsValue]):
    """One line for each motor, then how to test them."""

    def draw(self, width: int, height: int) -> list[Strip]:
        """Draw the motors that fit, and always the line about the test."""
        view = self.value.view
        if view is None or not view.system:
            return [strip((" no vehicle yet", style(DIM)))]
        texts = (self._status(view), self._strength(view), _stops())
        below = [line for parts in texts for line in _wrapped(parts, width)]
        motors = [self._motor(row, view, width) for row in view.motors]
        if not motors:
            motors = [[(" cannot: it is not known which motors this vehicle has", style(DIM))]]
        kept = max(1, height - 1)
        lines = [*motors[:kept], *below]
        return [cropped(strip(*line), width) for line in lines[:height]]

    def _motor(self, row: MotorRow, view: DoctorView, width: int) -> list[Part]:
        turns = view.test is not None and view.test.turning and view.test.motor == row.number
        key = style(YELLOW, bold=True) if self.value.testing else style(DIM)
        parts: list[Part] = [
            (f" {row.number} ", key),
            (f"{clean(row.name):<14}", style(AMBER if turns else TEXT, bold=turns)),
            (f"{clean(row.output):<11}", style(DIM)),
        ]
        parts += _bar(row.value) if width >= WIDE else []
        value = "   --" if row.value is None else f"{row.value:+5.0%}"
        parts.append((f" {value} ", style(AMBER if row.value else DIM)))
        if turns:
            return [*parts, ("turns", style(AMBER, bold=True))]
        return [*parts, ("tested ✓" if row.tested else "", style(GREEN))]

    def _status(self, view: DoctorView) -> list[Part]:
        test = view.test
        if test is not None and test.turning:
            return [(f" motor {test.motor} {test.text}, SPACE stops it", style(AMBER, bold=True))]
        if self.value.testing:
            done = f" · {clean(test.text)}" if test is not None else ""
            return [(" hold a key", style(YELLOW, bold=True)), (f": that motor turns, 2 s at most{done}", style(TEXT))]
        return [(" m", style(YELLOW, bold=True)), (" begins; then a motor turns while its key is held", style(DIM))]

    def _strength(self, view: DoctorView) -> list[Part]:
        reverses = " · v reverses the last one" if any(row.reversal for row in view.motors) else ""
        text = f" strength {self.value.strength:.0%} of {view.motor_limit:.0%} at most: + -{reverses}"
        return [(text, style(DIM))]


def _stops() -> list[Part]:
    return [(" any other key stops it, and the vehicle itself after 0.5 s", style(DIM))]


def _wrapped(parts: list[Part], width: int) -> list[list[Part]]:
    """Return a line, or its text in several lines where it is too long, in the look of its last part."""
    if length(parts) <= width:
        return [parts]
    text = "".join(text for text, _ in parts)
    return [[(f" {line}", parts[-1][1])] for line in wrap(text.strip(), width - 1)]


def _bar(value: float | None) -> Iterator[Part]:
    """Draw an output from the middle; not known: a dim line."""
    half = BAR // 2
    cells = 0 if value is None else max(-half, min(half, round(value * half)))
    left, right = max(0, -cells), max(0, cells)
    yield "·" * (half - left), style(DIM)
    yield "█" * left, style(AMBER)
    yield "│", style(DIM if value is None else TEXT)
    yield "█" * right, style(AMBER)
    yield "·" * (half - right), style(DIM)


def frame_note(view: DoctorView | None) -> str:
    """Return what stands in the frame."""
    return "not while armed" if view is not None and view.armed else "WHEELS OFF THE GROUND"
