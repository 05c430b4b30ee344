"""Decoders of what the encoders write, made from the specifications: what a terminal would show, as pixels."""

from __future__ import annotations

import re
import zlib
from base64 import b64decode

from groundstation.pictures.picture import Picture

Pixel = tuple[int, int, int]
_ANSI = re.compile(r"\x1b\[([\d;?]*)([A-Za-z])|(.)", re.DOTALL)
_LEVELS = (0, 95, 135, 175, 215, 255)


class CellScreen:
    """A terminal of cells, each with a character and the colours of its text and of its ground."""

    def __init__(self) -> None:
        self.cells: dict[tuple[int, int], tuple[str, Pixel, Pixel]] = {}
        self.moves = 0
        self._at = (1, 1)
        self._text: Pixel = (255, 255, 255)
        self._ground: Pixel = (0, 0, 0)

    def feed(self, data: str) -> None:
        for parameters, final, character in _ANSI.findall(data):
            if character:
                self.cells[self._at] = (character, self._text, self._ground)
                self._at = (self._at[0], self._at[1] + 1)
            elif final == "H":
                row, column = parameters.split(";")
                self._at = (int(row), int(column))
                self.moves += 1
            elif final == "J":
                self.cells.clear()
            elif final == "m":
                self._set_colour([int(each or 0) for each in parameters.split(";")])

    def pixels(self, row: int, column: int) -> tuple[Pixel, Pixel]:
        """The upper and the lower pixel of a cell."""
        character, text, ground = self.cells[row, column]
        return {"▀": (text, ground), " ": (ground, ground), "▄": (ground, text), "█": (text, text)}[character]

    def _set_colour(self, values: list[int]) -> None:
        first = values[0]
        if first == 0:
            self._text, self._ground = (255, 255, 255), (0, 0, 0)
        elif first in (38, 48):
            colour = (values[2], values[3], values[4]) if values[1] == 2 else colour_of_256(values[2])
            self._set(first == 48, colour)
        else:
            bright, ground = (
                first >= 90,
                first % 90 % 40 < 10 and first not in range(30, 38) and first not in range(90, 98),
            )
            self._set(ground, colour_of_16(first % 10 + 8 * bright))

    def _set(self, ground: bool, colour: Pixel) -> None:
        if ground:
            self._ground = colour
        else:
            self._text = colour


def colour_of_256(number: int) -> Pixel:
    """The colour of xterm."""
    if number < 16:
        return colour_of_16(number)
    if number >= 232:
        return (8 + 10 * (number - 232),) * 3
    cube = number - 16
    return _LEVELS[cube // 36], _LEVELS[cube // 6 % 6], _LEVELS[cube % 6]


def colour_of_16(number: int) -> Pixel:
    """A usual colour: which parts it has."""
    if number in (7, 8):
        return ((170,) if number == 7 else (85,)) * 3
    high = 255 if number > 7 else 170
    return tuple(high * (number >> bit & 1) for bit in range(3))  # type: ignore[return-value]


class KittyScreen:
    """What a terminal with kitty graphics keeps: images by id, and those that are placed."""

    def __init__(self) -> None:
        self.images: dict[str, Picture] = {}
        self.placed: dict[tuple[str, str], dict[str, str]] = {}
        self._keys: dict[str, str] = {}
        self._data = ""

    def feed(self, data: str) -> None:
        for keys_text, payload in re.findall(r"\x1b_G([^;\x1b]*);?([^\x1b]*)\x1b\\", data):
            keys = dict(each.split("=") for each in keys_text.split(","))
            assert len(payload) <= 4096
            assert keys["q"] == "2"  # no answers
            if keys.get("a") == "d":
                self.images.pop(keys["i"], None)
                self.placed = {each: at for each, at in self.placed.items() if each[0] != keys["i"]}
                continue
            if not self._keys:
                self._keys = keys
            self._data += payload
            if keys.get("m") == "0":
                self._finish()
            else:
                assert len(payload) % 4 == 0

    def _finish(self) -> None:
        keys, data = self._keys, zlib.decompress(b64decode(self._data, validate=True))
        assert (keys["a"], keys["f"], keys["o"], keys["t"], keys["C"]) == ("T", "24", "z", "d", "1")
        self.images[keys["i"]] = Picture(int(keys["s"]), int(keys["v"]), data)
        assert len(data) == 3 * int(keys["s"]) * int(keys["v"])
        self.placed[keys["i"], keys["p"]] = keys
        self._keys, self._data = {}, ""


def decode_sixel(data: str) -> Picture:
    """The picture of one sixel sequence; pixels that nothing draws are an error."""
    found = re.search(r'\x1bP0;1;0q"1;1;(\d+);(\d+)(.*?)\x1b\\', data, re.DOTALL)
    assert found is not None
    width, height = int(found[1]), int(found[2])
    pixels: dict[tuple[int, int], Pixel] = {}
    palette: dict[int, Pixel] = {}
    x = y = colour = 0
    for token in re.finditer(r"#(\d+)(?:;2;(\d+);(\d+);(\d+))?|!(\d+)(.)|(.)", found[3]):
        number, *parts, count, repeated, single = token.groups()
        if number is not None:
            colour = int(number)
            if parts[0] is not None:
                red, green, blue = (round(int(part) * 2.55) for part in parts)
                palette[colour] = (red, green, blue)
        elif single == "$":
            x = 0
        elif single == "-":
            x, y = 0, y + 6
        else:
            bits, wide = ord(repeated or single) - 63, int(count or 1)
            pixels |= {
                (x + across, y + bit): palette[colour] for across in range(wide) for bit in range(6) if bits >> bit & 1
            }
            x += wide
    assert len(pixels) == width * height
    rgb = bytes(part for row in range(height) for column in range(width) for part in pixels[column, row])
    return Picture(width, height, rgb)
