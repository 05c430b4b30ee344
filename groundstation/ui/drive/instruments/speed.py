"""Readout in digits three rows high: the speed, of what flies the altitude above home."""

from __future__ import annotations

from collections.abc import Iterator

import msgspec
from textual.strip import Strip

from groundstation.snapshot import VehicleView
from groundstation.ui.look.colours import DIM, GREEN, TEXT, style
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


class Readout(msgspec.Struct, frozen=True):
    """What the digits show."""

    text: str
    unit: str = " m/s"
    name: str = ""
    """Above the unit."""
    below: tuple[tuple[str, str], ...] = ()
    """Name and value of what is shown below the digits, where there is room."""

    @classmethod
    def from_vehicle(cls, vehicle: VehicleView | None) -> Readout:
        """Return the speed along the nose, or the altitude of what flies."""
        if vehicle is None or not vehicle.flies:
            return cls(speed_text(vehicle))
        altitude = finite_or_none(vehicle.altitude)
        text = " ---.-" if altitude is None else f"{max(-99.9, min(999.9, altitude)):5.1f}".replace("-0.0", " 0.0")
        return cls(text[-5:], " m", " alt", tuple(_flight_figures(vehicle)))


def _flight_figures(vehicle: VehicleView) -> Iterator[tuple[str, str]]:
    """Yield what belongs to the altitude: the climb, the speed, how high its fence is."""
    climb, speed = finite_or_none(vehicle.climb), finite_or_none(vehicle.speed_over_ground)
    yield "climb", " -.- m/s" if climb is None else f"{round(climb, 1) + 0.0:+.1f} m/s"
    yield "speed", " -.- m/s" if speed is None else f"{speed:.1f} m/s"
    if vehicle.altitude_fence is not None:
        yield "fence", f"{vehicle.altitude_fence:.0f} m"


class SpeedReadout(Instrument[Readout]):
    """Speed along the nose in m/s, or altitude in m."""

    def draw(self, width: int, height: int) -> list[Strip]:
        """Draw the digits in the middle of the height, the unit beside their last row."""
        rows = ["".join(GLYPHS[character][row] for character in self.value.text) for row in range(3)]
        look = style(DIM if "--" in self.value.text else GREEN, bold=True)
        beside = (self.value.name, "", self.value.unit)
        lines = [strip((row, look), (text, style(DIM))) for row, text in zip(rows, beside, strict=True)]
        below = self.value.below if height >= 3 + 1 + len(self.value.below) else ()
        if below:
            lines.append(strip((" " * width, style())))
            lines += [strip((f"{name}  ", style(DIM)), (f"{value:>9}", style(TEXT))) for name, value in below]
        return [strip((" " * width, style()))] * ((height - len(lines)) // 2) + lines
