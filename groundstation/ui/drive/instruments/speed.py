"""Speed readout, in digits three rows high."""

from __future__ import annotations

from textual.strip import Strip

from groundstation.snapshot import VehicleView
from groundstation.ui.look.colours import DIM, GREEN, style
from groundstation.ui.widgets.instrument import Instrument, finite_or_none, strip

GLYPHS = {
    "0": ("╭─╮", "│ │", "╰─╯"), "1": ("╶╮ ", " │ ", "╶┴╴"), "2": ("╶─╮", "╭─╯", "╰─╴"), "3": ("╶─╮", " ─┤", "╶─╯"),
    "4": ("╷ ╷", "╰─┤", "  ╵"), "5": ("╭─╴", "╰─╮", "╶─╯"), "6": ("╭─╴", "├─╮", "╰─╯"), "7": ("╶─╮", "  │", "  ╵"),
    "8": ("╭─╮", "├─┤", "╰─╯"), "9": ("╭─╮", "╰─┤", "╶─╯"), ".": (" ", " ", "."), "-": ("   ", "╶─╴", "   "),
    " ": ("   ", "   ", "   "),
}  # fmt: skip
"""Character -> its three rows."""


def speed_text(vehicle: VehicleView | None) -> str:
    """Return the speed in m/s as five characters, so that the point does not move; dashes where it is not known."""
    if vehicle is None or (speed := finite_or_none(vehicle.speed)) is None:
        return " -.--"
    return f"{max(-9.99, min(99.99, speed)):5.2f}".replace("-0.00", " 0.00")


class SpeedReadout(Instrument[str]):
    """Speed along the nose in m/s."""

    def draw(self, width: int, height: int) -> list[Strip]:
        """Draw the digits in the middle of the height, the unit beside their last row."""
        rows = ["".join(GLYPHS[character][row] for character in self.value) for row in range(3)]
        look = style(DIM if "--" in self.value else GREEN, bold=True)
        lines = [strip((row, look), (" m/s" if number == 2 else "", style(DIM))) for number, row in enumerate(rows)]
        return [strip((" " * width, style()))] * ((height - 3) // 2) + lines
