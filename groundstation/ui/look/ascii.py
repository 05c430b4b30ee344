"""ASCII in place of the characters that a terminal or a locale may lack: boxes, bars, arrows, braille."""

from __future__ import annotations

from collections.abc import Mapping

from rich.cells import cell_len
from rich.segment import Segment
from textual.color import Color
from textual.filter import LineFilter

_SAME = (
    ("╭╮╰╯┌┐└┘├┤┬┴┼┏┓┗┛╔╗╚╝", "+"), ("─━═╶╴╌┄▔▁", "-"), ("│┃║╷╵▏▕", "|"), ("█▉▊▋▌▍▎▐▇▆", "#"), ("▅▄", "="),
    ("▃▂", "_"), ("░▒▓", "-"), ("·•", "."), ("“”", '"'), ("‘’", "'"), ("–—", "-"), ("↑▲⇧", "^"), ("↓▼▾", "v"),
    ("←◀", "<"), ("→▶›▸", ">"), ("●■", "#"), ("×✗", "x"), ("°", " "), ("⌂", "H"), ("␣", "_"), ("…", "~"), ("µ", "u"),
    ("≤", "<"), ("²", "2"), ("○", "o"), ("✓", "+"), ("✎", "*"), ("★", "@"), ("�", "?"),
)  # fmt: skip
"""Characters and what stands for each of them."""

_BRAILLE = range(0x2800, 0x2900)

DENSITY = " ..::##***"[:9]
"""By the number of dots in a braille cell, 0 to 8."""


class _Table(dict[int, str]):
    """For str.translate: what is not listed keeps its width as question marks."""

    def __missing__(self, code: int) -> str:
        if code < 0x80:
            found = chr(code)
        elif code in _BRAILLE:
            found = DENSITY[(code - _BRAILLE.start).bit_count()]
        else:
            found = "?" * cell_len(chr(code))
        self[code] = found
        return found


_TABLE: Mapping[int, str] = _Table({ord(character): mark for characters, mark in _SAME for character in characters})


def to_ascii(text: str) -> str:
    """Return a text of the same width in ASCII."""
    return text if text.isascii() else text.translate(_TABLE)


class AsciiFilter(LineFilter):
    """Applies to every line that any widget draws, borders and scroll bars too."""

    def apply(self, segments: list[Segment], background: Color) -> list[Segment]:
        """Return the segments in ASCII."""
        return [Segment(to_ascii(text), style, control) for text, style, control in segments]
