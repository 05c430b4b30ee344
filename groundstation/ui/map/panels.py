"""Panels beside the map: the fields of an item, the plans here against those of the vehicle, and the progress."""

from __future__ import annotations

import msgspec
from textual.strip import Strip

from groundstation.ui.display.wrap import clean
from groundstation.ui.look.colours import AMBER, BLUE, DIM, FAINT, GREEN, TEXT, WHITE, YELLOW, style
from groundstation.ui.widgets.instrument import Instrument, Part, length, strip

LABEL = 14
"""Width of the labels."""


class PanelLine(msgspec.Struct, frozen=True):
    """A label, a value and a note at the right edge."""

    label: str
    value: str = ""
    note: str = ""
    look: str = ""
    """"good", "edited" or "warned"."""


class PanelValue(msgspec.Struct, frozen=True):
    """Lines of a panel."""

    lines: tuple[PanelLine, ...] = ()
    selected: int | None = None


_COLOURS = {"": TEXT, "good": GREEN, "edited": BLUE, "warned": AMBER, "faint": DIM}


class LinesPanel(Instrument[PanelValue]):
    """Labels with values; the selected line stays in view."""

    def draw(self, width: int, height: int) -> list[Strip]:
        """Draw the lines that fit."""
        selected = self.value.selected
        top = 0 if selected is None else max(0, selected - height + 1)
        return [
            _line(line, width, selected=number == selected)
            for number, line in enumerate(self.value.lines[top : top + height], start=top)
        ]


def _line(line: PanelLine, width: int, *, selected: bool) -> Strip:
    ground = {"on": FAINT} if selected else {}
    label, note = f" {line.label:<{LABEL}}"[: LABEL + 1], clean(line.note)
    value = clean(line.value)[: max(0, width - len(label))]
    room = max(0, width - len(label) - len(value) - 2)
    note = note if len(note) <= room else ""
    colour = WHITE if selected and not line.look else _COLOURS[line.look]
    gap = max(0, width - len(label) - len(value) - len(note) - 1)
    return strip(
        (label, style(DIM, **ground)),
        (value, style(colour, bold=selected or line.look == "edited", **ground)),
        (" " * gap, style(**ground)),
        (f"{note} ", style(_COLOURS[line.look] if line.look == "good" else DIM, **ground)),
    ).crop(0, width)


class TextLine(Instrument[str]):
    """One line of text."""

    def draw(self, width: int, height: int) -> list[Strip]:
        """Draw the line, cut at the right edge."""
        return [strip((f" {self.value}".ljust(width), style(TEXT))).crop(0, width)]


class ProgressValue(msgspec.Struct, frozen=True):
    """The mission as one line to scale, and texts about it."""

    stops: tuple[tuple[float, str, str], ...] = ()
    """Share of the way 0..1, label, and "done", "now" or ""."""
    done: float = 0.0
    """Share of the way that was driven."""
    target: float = 0.0
    """Share of the way at the current item."""
    texts: tuple[tuple[str, str], ...] = ()
    """Label and value."""
    note: str = ""
    """In place of them, where there is no mission."""


class ProgressStrip(Instrument[ProgressValue]):
    """The strip: done, the leg that is driven, to go; below it texts, as many as fit."""

    def draw(self, width: int, height: int) -> list[Strip]:
        """Draw the line, then the texts."""
        if self.value.note:
            return [strip((f" {self.value.note}"[:width], style(DIM)))]
        lines = [self._way(width)]
        parts: list[Part] = []
        for label, value in self.value.texts:
            item = [(f" {label} ", style(DIM)), (f"{value}  ", style(TEXT, bold=True))]
            if length(parts) + length(item) > width and len(lines) < height:
                lines.append(strip(*parts))
                parts = []
            parts += item
        return [*lines, strip(*parts)][:height]

    def _way(self, width: int) -> Strip:
        room = width - 2
        cells: list[Part] = []
        for column in range(room):
            share = column / max(1, room - 1)
            if share <= self.value.done:
                cells.append(("━", style(GREEN)))
            else:
                cells.append(("━", style(YELLOW)) if share <= self.value.target else ("─", style(DIM)))
        for share, label, look in self.value.stops:
            at = min(room - len(label), round(share * (room - 1)))
            colour = {"done": GREEN, "now": YELLOW}.get(look, TEXT)
            for offset, character in enumerate(label):
                cells[max(0, at) + offset] = (character, style(colour, bold=True))
        if 0 < self.value.done < 1:
            cells[round(self.value.done * (room - 1))] = ("▶", style(YELLOW, bold=True))
        return strip((" ", style()), *cells)
