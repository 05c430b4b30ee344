"""Table of parameters, and the changes that are not sent yet."""

from __future__ import annotations

from textual.strip import Strip

from groundstation.ui.colours import AMBER, DIM, FAINT, TEXT, WHITE, style
from groundstation.ui.param_model import ParamTableValue, PendingChange
from groundstation.ui.widgets.instrument import Instrument, Part, strip
from groundstation.ui.wrap import clean
from groundstation.views.params import ParamRow

NAME, VALUE, KIND = 17, 14, 7
"""Widths of the columns."""


def value_text(value: float) -> str:
    """Return a value as it is typed: whole numbers exactly, others with up to nine digits."""
    return f"{value:.0f}" if value == value and abs(value) < 1e15 and value == int(value) else f"{value:.9g}"


class ParamTable(Instrument[ParamTableValue]):
    """A row for each parameter: ● not at its default, ✎ a change that is not sent."""

    def draw(self, width: int, height: int) -> list[Strip]:
        """Draw the page."""
        if not self.value.rows:
            return [strip((f" {self.value.note}", style(DIM)))]
        pending = {change.name: change for change in self.value.pending}
        return [
            strip(*_row(row, pending.get(row.name), selected=index == self.value.selected, width=width)).crop(0, width)
            for index, row in enumerate(self.value.rows[:height])
        ]


def _row(row: ParamRow, change: PendingChange | None, *, selected: bool, width: int) -> list[Part]:
    ground = {"on": FAINT} if selected else {}
    mark = "✎" if change else "●" if row.changed else " "
    value = f"{value_text(row.value)} → {value_text(change.value)}" if change else value_text(row.value)
    default = "" if row.default is None or not row.changed else f"default {value_text(row.default)}"
    parts: list[Part] = [
        (f" {mark} ", style(AMBER if change or row.changed else DIM, **ground)),
        (f"{clean(row.name):<{NAME}}", style(WHITE if selected else TEXT, bold=selected, **ground)),
        (f"{value:<{VALUE}} ", style(AMBER if change else TEXT, **ground)),
        (f"{row.kind:<{KIND}} {default}", style(DIM, **ground)),
    ]
    used = sum(len(text) for text, _ in parts)
    return [*parts, (" " * max(0, width - used), style(**ground))]


class PendingList(Instrument[tuple[PendingChange, ...]]):
    """The changes that are not sent yet, old value first."""

    def draw(self, width: int, height: int) -> list[Strip]:
        """Draw as many as fit; the last line counts the others."""
        shown = self.value[: height - 1] if len(self.value) > height else self.value
        lines = [strip((f" {clean(each.name):<{NAME}}", style(TEXT)), _change(each)).crop(0, width) for each in shown]
        if len(shown) < len(self.value):
            lines.append(strip((f" and {len(self.value) - len(shown)} more", style(DIM))))
        return lines


def _change(change: PendingChange) -> Part:
    return f"{value_text(change.before)} → {value_text(change.value)}", style(AMBER)
