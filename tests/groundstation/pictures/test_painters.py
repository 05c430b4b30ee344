"""Each painter, read back by decoders of its protocol: exact where it has all colours, near where it has few."""

from __future__ import annotations

import random
import zlib

import pytest

from groundstation.pictures.cells import colour_16, colour_256
from groundstation.pictures.painters import MAX_LEVEL, PAINTERS, Area
from groundstation.pictures.picture import Picture
from groundstation.pictures.png import SIGNATURE, encode_png
from groundstation.pictures.protocol import Protocol
from groundstation.pictures.sixel import encode_sixel
from tests.groundstation.pictures.decoders import CellScreen, KittyScreen, decode_sixel
from tests.groundstation.ui.png_palette import read_chunks

AREA = Area(columns=20, rows=7, row=3, column=5)


def noise(width: int, height: int, seed: int = 1) -> Picture:
    return Picture(width, height, random.Random(seed).randbytes(3 * width * height))


def ramp(width: int, height: int) -> Picture:
    """Smooth colours, as a camera has."""
    return Picture(
        width,
        height,
        bytes(part for y in range(height) for x in range(width) for part in (x * 255 // width, y * 255 // height, 90)),
    )


def shown(screen: CellScreen, area: Area = AREA) -> Picture:
    cells = [
        [screen.pixels(area.row + y, area.column + x) for x in range(area.columns)] for y in range(area.rows)
    ]  # fmt: skip
    rows = [[cell[half] for cell in row] for row in cells for half in (0, 1)]
    return Picture(area.columns, 2 * area.rows, bytes(part for row in rows for pixel in row for part in pixel))


def greatest_fault(one: Picture, other: Picture) -> int:
    assert (one.width, one.height) == (other.width, other.height)
    return max(abs(a - b) for a, b in zip(one.rgb, other.rgb, strict=True))


def test_half_blocks_show_each_pixel() -> None:
    painter, screen = PAINTERS[Protocol.BLOCKS](), CellScreen()
    assert painter.fit(AREA) == (20, 14)
    for seed in range(3):
        screen.feed(painter.paint(picture := noise(20, 14, seed), AREA, 0))
        assert shown(screen) == picture
    assert len(screen.cells) == 20 * 7  # nothing outside of the area


def test_only_changed_cells_are_drawn_again() -> None:
    painter, screen = PAINTERS[Protocol.BLOCKS](), CellScreen()
    picture = noise(20, 14)
    screen.feed(painter.paint(picture, AREA, 0))
    assert painter.paint(picture, AREA, 0) == ""
    rgb = bytearray(picture.rgb)
    rgb[0:3] = rgb[-3:] = b"\x01\x02\x03"
    changed = Picture(20, 14, bytes(rgb))
    drawn = painter.paint(changed, AREA, 0)
    screen.feed(drawn)
    assert (shown(screen), drawn.count("H")) == (changed, 2)
    painter.clear()
    screen.feed("\x1b[2J" + painter.paint(changed, AREA, 0))
    assert shown(screen) == changed


def test_fewer_colours_are_the_nearest() -> None:
    for protocol, most in ((Protocol.BLOCKS_256, 48), (Protocol.BLOCKS_16, 170)):
        painter, screen, picture = PAINTERS[protocol](), CellScreen(), ramp(20, 14)
        screen.feed(painter.paint(picture, AREA, 0))
        assert greatest_fault(shown(screen), picture) <= most, protocol
    assert [colour_256(bytes(pixel), True) for pixel in ((0, 0, 0), (255, 255, 255), (8, 8, 8), (95, 0, 255))] == [
        "48;5;16", "48;5;231", "48;5;232", "48;5;57",
    ]  # fmt: skip
    assert [colour_16(bytes(pixel), False) for pixel in ((0, 0, 0), (170, 0, 0), (255, 255, 255))] == ["30", "31", "97"]
    assert [colour_16(bytes(pixel), True) for pixel in ((0, 170, 0), (0, 0, 255))] == ["42", "104"]


def test_ascii_is_brighter_where_the_picture_is() -> None:
    painter, screen = PAINTERS[Protocol.ASCII](), CellScreen()
    grey = Picture(20, 14, bytes(x * 12 for _ in range(14) for x in range(20) for _ in range(3)))
    drawn = painter.paint(grey, AREA, 0)
    assert drawn.isascii()
    screen.feed(drawn)
    line = "".join(screen.cells[3, 5 + x][0] for x in range(20))
    assert line == "   ..::--==++**###%%"
    assert painter.paint(grey, AREA, 0) == ""


def test_kitty_shows_one_picture_and_deletes_the_rest() -> None:
    painter, screen = PAINTERS[Protocol.KITTY](), KittyScreen()
    assert painter.fit(AREA) == (160, 112)
    for seed in range(3):
        drawn = painter.paint(picture := noise(160, 112, seed), AREA, 0)
        assert drawn.startswith("\x1b[3;5H\x1b_G")
        screen.feed(drawn)
        assert [*screen.images.values()] == [picture]
        ((_, keys),) = screen.placed.items()
        assert (keys["c"], keys["r"]) == ("20", "7")
    screen.feed(painter.paint(noise(160, 112), AREA, 3))
    assert [(each.width, each.height) for each in screen.images.values()] == [(40, 28)]
    screen.feed(painter.clear())
    assert not screen.images
    assert not screen.placed


@pytest.mark.slow
def test_sixel_shows_each_pixel_with_near_colours() -> None:
    painter = PAINTERS[Protocol.SIXEL]()
    assert painter.fit(AREA) == (160, 108)
    for picture, level, most in ((noise(160, 108), 0, 27), (ramp(160, 108), 0, 27), (ramp(160, 108), 1, 44)):
        drawn = painter.paint(picture, AREA, level)
        assert drawn.startswith("\x1b[3;5H\x1bP")
        assert greatest_fault(decode_sixel(drawn), picture) <= most


def test_a_recorded_sixel() -> None:
    red, blue = b"\xff\0\0", b"\0\0\xff"
    picture = Picture(5, 7, red * 5 * 6 + blue * 5)
    assert encode_sixel(picture) == '\x1bP0;1;0q"1;1;5;7#5;2;0;0;100#180;2;100;0;0#180!5~-#5!5@\x1b\\'


@pytest.mark.slow
@pytest.mark.parametrize("protocol", list(Protocol))
def test_a_coarser_picture_takes_fewer_bytes(protocol: Protocol) -> None:
    """Of noise: the worst picture there is."""
    area = Area(80, 22)
    sizes = []
    for level in range(MAX_LEVEL + 1):
        painter = PAINTERS[protocol]()
        sizes.append(len(painter.paint(noise(*painter.fit(area)), area, level).encode()))
    assert sizes == sorted(sizes, reverse=True)
    if protocol is not Protocol.ASCII:
        assert sizes[-1] < sizes[0] / 2


@pytest.mark.parametrize("protocol", list(Protocol))
def test_any_size_of_picture_and_area_is_drawn(protocol: Protocol) -> None:
    for area in (Area(2, 1), Area(500, 300), Area(3, 90)):
        painter = PAINTERS[protocol]()
        width, height = painter.fit(area)
        assert width * height <= 640 * 360
        for level in (0, MAX_LEVEL):
            assert painter.paint(noise(7, 3), area, level)


def test_a_greyed_picture_has_no_colours() -> None:
    grey = noise(30, 20).greyed()
    assert all(len({*grey.rgb[at : at + 3]}) == 1 for at in range(0, len(grey.rgb), 3))
    assert Picture(1, 1, b"\xff\xff\xff").greyed().rgb[0] - Picture(1, 1, bytes(3)).greyed().rgb[0] < 200


def test_a_png_has_every_pixel() -> None:
    picture = noise(31, 17)
    data = encode_png(picture)
    chunks = dict(read_chunks(data))
    assert data.startswith(SIGNATURE)
    assert [*chunks] == [b"IHDR", b"IDAT", b"IEND"]
    assert chunks[b"IHDR"] == bytes.fromhex("0000001f 00000011 08 02 00 00 00")
    rows = zlib.decompress(chunks[b"IDAT"])
    assert rows == b"".join(b"\0" + picture.row(y) for y in range(17))
