"""The changes that are not written yet: what is on the vehicle, what will be, and what can be said of it."""

from __future__ import annotations

from collections.abc import Mapping

import msgspec
from textual.strip import Strip

from groundstation.ui.look.colours import AMBER, BLUE, DIM, GREEN, RED, TEXT, style
from groundstation.ui.params.edit.checks import Level, check_value, meaning_of, needs_care
from groundstation.ui.params.edit.pending import PendingChange
from groundstation.ui.widgets.columns import Column, fit, header, row
from groundstation.ui.widgets.instrument import Instrument, Part, strip
from groundstation.views.params import ParamInfo
from link.services.param.float32 import value_text

COLUMNS = (
    Column("", 1),
    Column("name", 16, most=20),
    Column("on the vehicle", 14, most=26),
    Column("will be", 14, most=26),
    Column("default", 8, weight=2, most=12),
    Column("check", 14, weight=1, most=40),
)
_CHECK_COLOURS = {Level.GOOD: GREEN, Level.WARNING: AMBER, Level.UNKNOWN: DIM}


class PendingValue(msgspec.Struct, frozen=True):
    """The changes, and what is known of their parameters."""

    changes: tuple[PendingChange, ...] = ()
    infos: Mapping[str, ParamInfo] = msgspec.field(default_factory=dict)
    armed: bool = False
    """Those that need care while armed are marked."""
    last: str = ""
    """How the last write ended."""


class PendingList(Instrument[PendingValue]):
    """A line for each change, the old value with -, the new one with +."""

    def draw(self, width: int, height: int) -> list[Strip]:
        """Draw as many as fit; the last line counts the others."""
        changes, widths = self.value.changes, fit(COLUMNS, width - 2)
        lines = [header(COLUMNS, widths)] if height > len(changes) else []
        room = height - len(lines)
        shown = changes[: room - 1] if len(changes) > room else changes
        lines += [row(COLUMNS, widths, self._cells(each, widths[-1])) for each in shown]
        if len(shown) < len(changes):
            lines.append(strip((f"and {len(changes) - len(shown)} more", style(DIM))))
        if self.value.last and len(lines) < height:
            lines.append(strip((self.value.last, style(DIM))))
        return [Strip([*strip((" ", style())), *line]).crop(0, width) for line in lines]

    def _cells(self, change: PendingChange, width: int) -> list[Part]:
        info = self.value.infos.get(change.name)
        check = check_value(info, change.value)
        care = self.value.armed and needs_care(info, change.name)
        default = "" if info is None or info.default is None else value_text(info.default)
        text = "ARMED: care!" if care else check.fitted(width)
        return [
            ("!" if care else "✎", style(AMBER if care else BLUE)),
            (change.name, style(AMBER if care else TEXT, bold=True)),
            (f"- {_with_meaning(info, change.before)}", style(RED)),
            (f"+ {_with_meaning(info, change.value)}", style(GREEN)),
            (default, style(DIM)),
            (text, style(AMBER if care else _CHECK_COLOURS[check.level])),
        ]


def _with_meaning(info: ParamInfo | None, value: float) -> str:
    meaning = meaning_of(info, value) or (info.unit if info else "")
    return f"{value_text(value)} {meaning}".rstrip()
