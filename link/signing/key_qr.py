"""A text as a QR code in a terminal, drawn by the package `segno`."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import zip_longest

from link.signing.missing_package import MissingPackageError

BORDER = 4
"""Modules of quiet zone on each side: ISO/IEC 18004."""
DARK_ON_LIGHT = "\x1b[30;107m"
"""Black on bright white, whatever the colours of the terminal: scanners do not read light on dark."""
DARK, LIGHT = "\x1b[40m", "\x1b[107m"
RESET = "\x1b[0m"
HALVES = {(0, 0): " ", (1, 0): "\u2580", (0, 1): "\u2584", (1, 1): "\u2588"}
"""Upper and lower module -> block character."""


def draw_qr(text: str, *, unicode: bool) -> str:
    """Return the lines of a QR code. `unicode`: with half blocks, else two spaces a module, four times as large.

    Raises MissingPackageError.
    """
    rows = _modules(text)
    lines = _half_blocks(rows) if unicode else [_spaces(row) for row in rows]
    return "".join(f"{line}{RESET}\n" for line in lines)


def _modules(text: str) -> list[Sequence[int]]:
    try:
        import segno
    except ImportError:
        raise MissingPackageError("QR codes need", "segno") from None
    return [tuple(row) for row in segno.make(text, micro=False).matrix_iter(border=BORDER)]


def _half_blocks(rows: list[Sequence[int]]) -> list[str]:
    pairs = zip_longest(rows[::2], rows[1::2], fillvalue=(0,) * len(rows))  # a code is a square with an odd side
    return [DARK_ON_LIGHT + "".join(HALVES[pair] for pair in zip(*each, strict=True)) for each in pairs]


def _spaces(row: Sequence[int]) -> str:
    return "".join(f"{DARK if module else LIGHT}  " for module in row)
