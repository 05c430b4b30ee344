r"""The mouse: reports are asked for, no report is ever a key, and whole ones point at what is shown off Drive.

Without mouse reports many terminals turn the wheel into arrow keys on the alternate screen ("alternate scroll", DEC
private mode 1007), and the up arrow means "drive forward". Switching mode 1007 off is enough for most terminals, but
does not reach the terminal outside of tmux; asking for mouse reports does. See "Mouse Tracking" in
https://invisible-island.net/xterm/ctlseqs/ctlseqs.html.
"""

from __future__ import annotations

import re

from textual.message import Message

SAVE_WHEEL_MODE = "\x1b[?1007s"
"""XTSAVE of the alternate scroll mode: its default differs between terminals (on in VTE, off in xterm)."""

CAPTURE_MOUSE = "\x1b[?1000;1006h\x1b[?1007l"
"""Report buttons and the wheel (1000) with decimal coordinates (1006), and switch alternate scroll off (1007).

Motion (1002, 1003) is not reported: each report would wake the input thread.
"""

RELEASE_MOUSE = "\x1b[?1000;1006l\x1b[?1007h\x1b[?1007r"
"""Undo CAPTURE_MOUSE. Terminals that know XTRESTORE end with the saved mode 1007, the others with it switched on."""

_REPORT = re.compile(r"\x1b\[<(\d{1,3});(\d{1,4});(\d{1,4})M")
"""A press in the SGR encoding (mode 1006): button, column and row from 1."""

_STEPS = {64: -1, 65: 1}
"""Button of the wheel -> direction."""


class MouseReport(Message, bubble=False):
    """A click with the left button, or a notch of the wheel.

    Not an event of Textual: those choose a focus, select text and scroll by themselves, on Drive as well.
    """

    def __init__(self, column: int, row: int, wheel: int = 0) -> None:
        """`column` and `row` count from 0; `wheel` is -1 up, 1 down, 0 for a click."""
        super().__init__()
        self.column, self.row, self.wheel = column, row, wheel


def parse_report(sequence: str) -> MouseReport | None:
    """Return what a report says; None for a release, another button, a key held with it and another encoding."""
    found = _REPORT.fullmatch(sequence)
    if found is None:
        return None
    button, column, row = map(int, found.groups())
    if min(column, row) < 1 or (button and button not in _STEPS):
        return None
    return MouseReport(column - 1, row - 1, _STEPS.get(button, 0))
