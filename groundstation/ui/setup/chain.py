"""The chain from the finger to the wheel: a mark, a reason and what to do for each link."""

from __future__ import annotations

from collections.abc import Iterator

import msgspec
from textual.strip import Strip

from groundstation.ui.display.wrap import clean
from groundstation.ui.look.colours import AMBER, BLUE, DIM, FAINT, GREEN, RED, TEXT, WHITE, style
from groundstation.ui.setup.model import ChainLine, chain_lines
from groundstation.ui.widgets.instrument import Instrument, Part, length, strip
from groundstation.views.doctor import DoctorRow
from link.runtime.diagnosis import Health

MARKS: dict[Health, tuple[str, str]] = {
    Health.OK: ("✓", GREEN), Health.WARNING: ("!", AMBER), Health.FAULT: ("✗", RED), Health.UNKNOWN: ("·", DIM),
}  # fmt: skip
"""Health -> mark and colour. The marks differ without colours, too."""

TITLE = 15
"""Cells of mark and title."""

STRIP = ("keys", "station", "link", "vehicle", "control", "pre_arm", "mode", "armed", "motors")
"""Rows of the picture of the chain."""


class ChainValue(msgspec.Struct, frozen=True):
    """The rows, the one under the cursor, and what to do next."""

    rows: tuple[DoctorRow, ...] = ()
    selected: str = ""
    steps: tuple[str, ...] = ()


class ChainPanel(Instrument[ChainValue]):
    """The rows; below them, where there is room, the picture of the chain and what to do next."""

    def draw(self, width: int, height: int) -> list[Strip]:
        """Draw the rows around the cursor."""
        value = self.value
        if not value.rows:
            return [strip((" waiting for the station", style(DIM)))]
        lines = chain_lines(value.rows, height)
        at = next((index for index, line in enumerate(lines) if value.selected in map(_id, line.rows)), 0)
        top = max(0, min(at - height + 1, len(lines) - height))
        shown = [self._line(line, width) for line in lines[top : top + height]]
        room = height - len(shown)
        return [*shown, *self._picture(width, room), *self._steps(width, room - 2)]

    def cursor_line(self) -> int | None:
        """Return the line of the selected row."""
        lines = chain_lines(self.value.rows, self.size.height)
        at = next((index for index, line in enumerate(lines) if self.value.selected in map(_id, line.rows)), None)
        return None if at is None else at - max(0, min(at - self.size.height + 1, len(lines) - self.size.height))

    def _line(self, line: ChainLine, width: int) -> Strip:
        row, selected = line.row, self.value.selected in map(_id, line.rows)
        ground = {"on": FAINT} if selected else {}
        mark, colour = MARKS[row.health]
        title = row.title if len(line.rows) == 1 else f"{line.rows[0].title} → {row.title}"
        look = style(DIM if row.health is Health.UNKNOWN else TEXT, **ground)
        name = style(
            WHITE if selected or row.health is Health.FAULT else TEXT, bold=row.health is Health.FAULT, **ground
        )
        head: list[Part] = [(f" {mark} ", style(colour, bold=True, **ground)), (f"{title:<{TITLE - 3}} ", name)]
        room = max(1, width - length(head))
        evidence, proposal = "all well", ""
        if len(line.rows) == 1:
            evidence, proposal = clean(row.evidence), propose(row, room - len(clean(row.evidence)) - 3)
        room = max(1, room - len(proposal) - (2 if proposal else 1))
        text = evidence if len(evidence) <= room else f"{evidence[: room - 1]}…"
        return strip(
            *head, (f"{text:<{room}}", look), (f" {proposal} " if proposal else " ", style(BLUE, **ground))
        ).crop(0, width)

    def _picture(self, width: int, room: int) -> list[Strip]:
        """Draw the chain as one line: it breaks at what stops the operator."""
        if room < 2:
            return []
        parts: list[Part] = [("  ", style())]
        for row in (row for row in self.value.rows if row.id in STRIP):
            mark, colour = MARKS[row.health]
            link = " ━ " if row.health in (Health.OK, Health.WARNING) else f" {mark} "
            parts += [
                (link, style(colour, bold=True)),
                (row.title, style(colour if row.health is Health.FAULT else TEXT)),
            ]
        return [Strip([]), strip(*parts)] if length(parts) <= width else []

    def _steps(self, width: int, room: int) -> list[Strip]:
        steps = self.value.steps[: max(0, room - 2)]
        if not steps:
            return []
        numbered = (
            strip((f"  {number} ", style(AMBER, bold=True)), (clean(step), style(TEXT))).crop(0, width)
            for number, step in enumerate(steps, 1)
        )
        return [Strip([]), strip(("  what to do next", style(WHITE, bold=True))), *numbered]


def _id(row: DoctorRow) -> str:
    return row.id


def propose(row: DoctorRow, room: int) -> str:
    """Return what a key does about a row, in short where the room is too small."""
    if row.fix is not None:
        return f"f sets {row.fix.value:g}"
    if not row.action:
        return row.advice if len(row.advice) <= room else ""
    whole = f"ENTER: {row.advice}"
    return whole if len(whole) <= room else "ENTER"


def counts(rows: tuple[DoctorRow, ...]) -> str:
    """Return how many rows stop the operator, need a look, and are well."""
    return " · ".join(_counts(rows))


def _counts(rows: tuple[DoctorRow, ...]) -> Iterator[str]:
    names = {Health.FAULT: ("stops you", "stop you"), Health.WARNING: ("to look at",) * 2, Health.OK: ("well",) * 2}
    for health, (one, several) in names.items():
        count = sum(row.health is health for row in rows)
        if count:
            yield f"{count} {one if count == 1 else several}"
