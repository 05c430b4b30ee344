"""Contrast of text and background, with the colours that different terminals show, and what is sent to them."""

from __future__ import annotations

import gc
import re
from functools import cache

from rich.color import Color, ColorSystem
from rich.palette import Palette
from rich.style import Style

TEXT_CONTRAST = 4.5
"""WCAG 2.1, 1.4.3: the least contrast between text and its background."""


def contrast(ink: tuple[int, int, int], ground: tuple[int, int, int]) -> float:
    """Return the contrast of two colours, 1 to 21 (WCAG 2.1)."""
    low, high = sorted((luminance(ink), luminance(ground)))
    return (high + 0.05) / (low + 0.05)


def luminance(colour: tuple[int, int, int]) -> float:
    """Return the relative luminance of an sRGB colour."""
    parts = [each / 255 for each in colour]
    red, green, blue = (each / 12.92 if each <= 0.03928 else ((each + 0.055) / 1.055) ** 2.4 for each in parts)
    return 0.2126 * red + 0.7152 * green + 0.0722 * blue


XTERM_16 = Palette(
    [
        (0, 0, 0), (205, 0, 0), (0, 205, 0), (205, 205, 0), (0, 0, 238), (205, 0, 205), (0, 205, 205), (229, 229, 229),
        (127, 127, 127), (255, 0, 0), (0, 255, 0), (255, 255, 0), (92, 92, 255), (255, 0, 255), (0, 255, 255),
        (255, 255, 255),
    ]
)  # fmt: skip
"""What xterm shows for them (its XTerm-col.ad)."""

LINUX_16 = Palette(
    [
        (0, 0, 0), (170, 0, 0), (0, 170, 0), (170, 85, 0), (0, 0, 170), (170, 0, 170), (0, 170, 170), (170, 170, 170),
        (85, 85, 85), (255, 85, 85), (85, 255, 85), (255, 255, 85), (85, 85, 255), (255, 85, 255), (85, 255, 255),
        (255, 255, 255),
    ]
)  # fmt: skip
"""What the Linux console shows."""


PALETTES = {"xterm": XTERM_16, "linux": LINUX_16}
"""Terminals with 16 colours."""


@cache
def shown(colour: str, depth: str) -> tuple[int, int, int]:
    """Return what a terminal shows for a colour."""
    parsed = Color.parse(colour)
    if depth in PALETTES:
        number = parsed.downgrade(ColorSystem.STANDARD).number
        assert number is not None
        red, green, blue = PALETTES[depth][number]
    else:
        red, green, blue = (parsed.downgrade(ColorSystem.EIGHT_BIT) if depth == "256" else parsed).get_truecolor()
    return red, green, blue


SGR = re.compile(rb"\x1b\[([0-9;]*)m")


def colour_codes(drawn: bytes) -> set[int]:
    """Return the numbers of all colours that were sent to a terminal."""
    short = re.sub(rb"([34]8);5;[0-9]+", rb"\1", drawn)  # the number of one of 256 follows
    numbers = {int(number) for codes in SGR.findall(short) for number in codes.split(b";") if number}
    return {number for number in numbers if 30 <= number <= 49 or 90 <= number <= 107}


def forget_drawn_styles() -> None:
    """Let all styles be drawn anew: Rich keeps the codes of the terminal that a style was drawn for first."""
    gc.unfreeze()  # what is exempt from collections is not listed
    for each in gc.get_objects():
        if isinstance(each, Style):
            each._ansi = None
    gc.freeze()
