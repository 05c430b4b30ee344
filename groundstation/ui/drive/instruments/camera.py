"""Camera pane: the picture in half blocks, or in characters, with a line that tells its age."""

from __future__ import annotations

from functools import lru_cache
from itertools import groupby

from rich.color import Color
from rich.segment import Segment
from rich.style import Style
from textual.strip import Strip

from groundstation.pictures.cells import HALF_BLOCK, RAMP
from groundstation.pictures.picture import Picture
from groundstation.ui.drive.camera_feed import CameraValue
from groundstation.ui.look.colours import BLACK, RED, TEXT, style
from groundstation.ui.widgets.instrument import Instrument, cropped, strip

ROUGH = bytes(value & 0xF8 | value >> 5 for value in range(256))
"""32 levels a channel: neighbours become equal, and the line shorter."""


class CameraPicture(Instrument[CameraValue]):
    """A cell shows two pixels, one above the other."""

    @property
    def pixels(self) -> tuple[int, int]:
        """Width and height of the pictures that fit; both are even."""
        size = self.size
        return size.width & ~1, max(0, 2 * (size.height - 1))

    def draw(self, width: int, height: int) -> list[Strip]:
        """Draw the picture, and its age below it."""
        value = self.value
        fits = (width & ~1, 2 * (height - 1))
        lines = [] if value.picture is None or min(fits) < 2 else _draw_picture(value.picture.resized(*fits), value)
        blank = strip((" " * width, style()))
        lines += [blank] * (height - 1 - len(lines))
        text = f" {value.text}".ljust(width)
        look = style(BLACK, on=RED, bold=True) if value.grey and value.picture is not None else style(TEXT)
        return [*lines, cropped(strip((text, look)), width)]


def _draw_picture(picture: Picture, value: CameraValue) -> list[Strip]:
    shown = picture.greyed() if value.grey else picture
    if value.ascii:
        light, width = shown.brightness(), shown.width
        rows = [light[y * width : (y + 1) * width] for y in range(0, shown.height, 2)]
        return [strip(("".join(RAMP[level * len(RAMP) // 256] for level in row), style(TEXT))) for row in rows]
    rough = Picture(shown.width, shown.height, shown.rgb.translate(ROUGH))
    return [_draw_row(rough, y) for y in range(0, rough.height - 1, 2)]


def _draw_row(picture: Picture, y: int) -> Strip:
    upper, lower = picture.row(y), picture.row(y + 1)
    cells = (upper[at : at + 3] + lower[at : at + 3] for at in range(0, len(upper), 3))
    return Strip([Segment(HALF_BLOCK * len(list(run)), _look(cell)) for cell, run in groupby(cells)], picture.width)


@lru_cache(1 << 14)
def _look(cell: bytes) -> Style:
    return Style(color=Color.from_rgb(*cell[:3]), bgcolor=Color.from_rgb(*cell[3:]))
