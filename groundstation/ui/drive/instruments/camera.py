"""Camera pane: the picture in half blocks, characters or kitty graphics, with a line that tells its age."""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache
from itertools import groupby, zip_longest

from rich.color import Color
from rich.segment import Segment
from rich.style import Style
from textual.geometry import Region
from textual.strip import Strip

from groundstation.pictures.cell_lines import INKS, LEVELS, CellLines, simplify
from groundstation.pictures.cells import HALF_BLOCK, RAMP
from groundstation.pictures.painters import Area, KittyPainter
from groundstation.pictures.picture import Picture
from groundstation.pictures.protocol import Protocol
from groundstation.ui.drive.camera_feed import CameraValue
from groundstation.ui.look.colours import BLACK, RED, TEXT, style
from groundstation.ui.terminal.prepared_line import PreparedLine
from groundstation.ui.widgets.instrument import Instrument, cropped, strip

COARSEST = {Protocol.KITTY: 7, Protocol.ASCII: 0}
"""Way -> its coarsest level; of the others it is that of LEVELS."""
TYPICAL = 0.4
"""Bytes that kitty graphics need for each pixel, until a picture tells."""


class CameraPicture(Instrument[CameraValue]):
    """A cell shows two pixels, one above the other; or kitty graphics show finer ones over blank cells."""

    def __init__(self, value: CameraValue, *, id: str | None = None) -> None:  # noqa: A002
        super().__init__(value, id=id)
        self._lines = {protocol: CellLines(ink) for protocol, ink in INKS.items()}
        self._painted: tuple[object, dict[int, list[Strip]]] = (None, {})
        """The picture and its area, and its lines at each level that was measured or drawn."""
        self._prepared: list[PreparedLine] = []
        """The lines of the newest picture in half blocks: one that stays the same is the same object."""
        self._painter = KittyPainter()
        self._overlaid: object = None
        """What the pixels over the cells show; None: nothing."""
        self._covered = False
        """The cells were drawn, which removes the pixels over them."""
        self._share = TYPICAL
        """Bytes that kitty graphics needed for each pixel of the newest picture."""

    def fit(self, protocol: Protocol, cell: tuple[int, int]) -> tuple[int, int]:
        """Return width and height of the pictures that fit; both are even. Zero without room."""
        size = self.size
        if size.width < 2 or size.height < 2:
            return 0, 0
        if protocol is Protocol.KITTY:
            return self._painter.fit(Area(size.width, size.height - 1, cell=cell))
        return size.width & ~1, 2 * (size.height - 1)

    def draw(self, width: int, height: int) -> list[Strip]:
        """Draw the picture, and its age below it."""
        value = self.value
        lines = self._cells(value, width, height - 1) if min(width, height) >= 2 else []
        lines = lines + [strip((" " * width, style()))] * (height - 1 - len(lines))
        text = f" {value.text}".ljust(width)
        look = style(BLACK, on=RED, bold=True) if value.grey and value.picture is not None else style(TEXT)
        return [*lines, cropped(strip((text, look)), width)]

    def measure(self, value: CameraValue) -> int:
        """Return about how many bytes the picture of a value takes on the line to the terminal."""
        size = self.size
        if value.protocol is Protocol.KITTY:
            return int(self._share * _pixels_of(value) / (value.level + 1) ** 2)
        lines = self._cells(value, size.width, size.height - 1) if min(size) >= 2 else []
        pairs = zip_longest(lines, self._strips[: len(lines)])
        changed = (line for line, before in pairs if line is not before and line != before)
        return sum(line.written for line in changed if isinstance(line, PreparedLine))

    def cursor_line(self) -> int | None:
        """Return None: pictures have no cursor."""
        return None

    def coarsest(self, protocol: Protocol) -> int:
        """Return the coarsest level of a way to draw."""
        return COARSEST.get(protocol, len(LEVELS) - 1)

    def overlay(self, cell: tuple[int, int]) -> str:
        """Return what draws the pixels over the cells, if they have changed or were covered; "" for nothing."""
        value = self.value
        if value.picture is None or value.protocol is not Protocol.KITTY or not self.display or min(self.size) < 2:
            return self.uncover()
        shown = (value.number, value.grey, value.level, self.region, cell)
        if shown == self._overlaid and not self._covered:
            return ""
        self._covered, self._overlaid = False, shown
        region = self.region
        area = Area(region.width, region.height - 1, region.y + 1, region.x + 1, cell)
        text = self._painter.paint(value.picture.greyed() if value.grey else value.picture, area, value.level)
        self._share = len(text) * (value.level + 1) ** 2 / max(1, _pixels_of(value))
        return f"\x1b7{text}\x1b8"

    def uncover(self) -> str:
        """Return what removes the pixels over the cells, where clearing the cells does not."""
        if self._overlaid is None:
            return ""
        self._overlaid = None
        return self._painter.clear()

    def render_lines(self, crop: Region) -> list[Strip]:
        """Return lines; who draws them writes over the pixels there."""
        self._covered |= crop.y < self.size.height - 1
        return super().render_lines(crop)

    def _cells(self, value: CameraValue, width: int, rows: int) -> list[Strip]:
        """Return the lines of the picture, from before if they are the same."""
        if value.picture is None or value.protocol is Protocol.KITTY:
            return []
        key = (value.number, id(value.picture), value.grey, value.protocol, width, rows)
        if self._painted[0] != key:
            self._painted = key, {}
        levels = self._painted[1]
        if value.level not in levels:
            shown = value.picture.greyed() if value.grey else value.picture
            levels[value.level] = self._paint(shown, value, width, rows)
        return levels[value.level]

    def _paint(self, picture: Picture, value: CameraValue, width: int, rows: int) -> list[Strip]:
        if value.protocol is Protocol.ASCII:
            light = picture.resized(width, 2 * rows).brightness()
            lines = [light[y * width : (y + 1) * width] for y in range(0, 2 * rows, 2)]
            return [strip(("".join(RAMP[level * len(RAMP) // 256] for level in row), style(TEXT))) for row in lines]
        shown = simplify(picture, width, rows, value.level)
        texts = self._lines[value.protocol].draw(shown)
        self._prepared = [
            before
            if before is not None and before.drawn is text
            else PreparedLine(text, width, _segments_of(shown, 2 * y))
            for y, (text, before) in enumerate(zip_longest(texts, self._prepared[: len(texts)]))
        ]
        return list(self._prepared)


def _pixels_of(value: CameraValue) -> int:
    return 0 if value.picture is None else value.picture.width * value.picture.height


def _segments_of(picture: Picture, y: int) -> Callable[[], list[Segment]]:
    """Return what makes the segments of the cells whose upper pixels are row y."""

    def build() -> list[Segment]:
        upper, lower = picture.row(y), picture.row(y + 1)
        cells = (upper[at : at + 3] + lower[at : at + 3] for at in range(0, len(upper), 3))
        return [Segment(HALF_BLOCK * len(list(run)), _look(cell)) for cell, run in groupby(cells)]

    return build


@lru_cache(1 << 14)
def _look(cell: bytes) -> Style:
    return Style(color=Color.from_rgb(*cell[:3]), bgcolor=Color.from_rgb(*cell[3:]))
