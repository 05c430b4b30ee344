"""Health panel: one line for each subsystem, those to look at first."""

from __future__ import annotations

from textual.strip import Strip

from groundstation.snapshot.drive import HealthLine
from groundstation.ui.display.wrap import clean
from groundstation.ui.look.colours import AMBER, DIM, GREEN, TEXT, style
from groundstation.ui.widgets.instrument import Instrument, cropped, strip

NAME = 10
"""Cells of the name."""

MARKS = {True: ("✓", GREEN), False: ("!", AMBER), None: ("·", DIM)}


class HealthPanel(Instrument[tuple[HealthLine, ...]]):
    """Words with a mark, so that no colour is needed."""

    BORDER_TITLE = "health"

    def draw(self, width: int, height: int) -> list[Strip]:
        """Draw as many as fit, then how many are left and how many of those are good."""
        lines = self.value
        if not lines:
            return [strip(("the vehicle tells nothing yet", style(DIM))).crop(0, width)]
        shown = lines if len(lines) <= height else lines[: max(0, height - 1)]
        drawn = [cropped(_line(line), width) for line in shown]
        hidden = lines[len(shown) :]
        if hidden:
            bad = sum(line.good is False for line in hidden)
            what = f"{bad} to look at" if bad else "none to look at"
            drawn.append(strip((f"and {len(hidden)} more, {what}", style(AMBER if bad else DIM))).crop(0, width))
        return drawn


def _line(line: HealthLine) -> Strip:
    mark, colour = MARKS[line.good]
    return strip(
        (f"{mark} ", style(colour, bold=line.good is False)),
        (f"{clean(line.name):<{NAME}}", style(DIM)),
        (clean(line.text), style(DIM if line.good is None else TEXT)),
    )
