"""Bytes a second of the last minute, as columns."""

from __future__ import annotations

from textual.strip import Strip

from groundstation.ui.look.colours import BLUE, DIM, LINE, style
from groundstation.ui.widgets.canvas import Canvas
from groundstation.ui.widgets.instrument import Instrument, strip

SECONDS = 60
"""Rates that the width shows, one a second."""


class ByteGraph(Instrument[tuple[int, ...]]):
    """Columns from 0 to the largest rate; the newest is at the right edge."""

    def draw(self, width: int, height: int) -> list[Strip]:
        """Draw the columns."""
        if not self.value:
            return [strip((" nothing yet", style(DIM)))]
        canvas, most = Canvas(width, height), max(1, *self.value)
        for x in range(canvas.across):
            index = len(self.value) - SECONDS + x * SECONDS // canvas.across
            rate = self.value[index] if 0 <= index < len(self.value) else 0
            canvas.dot(x, canvas.down - 1, style(LINE))
            if rate:
                dots = max(1, round(rate / most * canvas.down))
                canvas.run(x, canvas.down - dots, canvas.down - 1, style(BLUE))
        return canvas.strips()


def most_text(rates: tuple[int, ...]) -> str:
    """Return the largest rate, which reaches the top."""
    most = max(rates, default=0)
    return f"top {most / 1000:.1f} kB/s · 60 s" if most >= 1000 else f"top {most} B/s · 60 s"
