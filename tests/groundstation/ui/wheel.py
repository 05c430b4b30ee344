"""What a terminal sends for one notch of the mouse wheel, from the modes that the program has set in it."""

from __future__ import annotations

import re

NOTCH = 3
"""Arrow keys per notch with alternate scroll, as VTE sends them."""

UP, DOWN = 64, 65
"""Buttons of the wheel in a mouse report."""

_MODES = re.compile(rb"\x1b\[\?([\d;]+)([hlsr])")
_MOUSE = (1000, 1002, 1003)


def modes(drawn: bytes, default: bool = True) -> dict[int, bool]:
    """Return the private modes after all that was drawn; `default` is that of alternate scroll (1007)."""
    now, saved = {1007: default}, dict[int, bool]()
    for numbers, verb in _MODES.findall(drawn):
        for mode in map(int, numbers.split(b";")):
            if verb == b"s":
                saved[mode] = now.get(mode, False)
            elif verb == b"r":
                now[mode] = saved.get(mode, now.get(mode, False))
            else:
                now[mode] = verb == b"h"
    return now


def notch(drawn: bytes, button: int = UP) -> bytes:
    """Return the bytes of one notch: a mouse report, arrow keys, or nothing where the terminal scrolls by itself."""
    mode = modes(drawn)
    if any(mode.get(each) for each in _MOUSE):
        return b"\x1b[<%d;11;12M" % button if mode.get(1006) else b"\x1b[M" + bytes((32 + button, 43, 44))
    if mode.get(1049) and mode[1007]:
        return (b"\x1b[A" if button == UP else b"\x1b[B") * NOTCH
    return b""
