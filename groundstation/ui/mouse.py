r"""Mouse wheel protection: ask the terminal for mouse reports, then discard every report.

Without mouse reports many terminals turn the wheel into arrow keys on the alternate screen ("alternate scroll", DEC
private mode 1007), and the up arrow means "drive forward". Switching mode 1007 off is enough for most terminals, but
does not reach the terminal outside of tmux; asking for mouse reports does. See "Mouse Tracking" in
https://invisible-island.net/xterm/ctlseqs/ctlseqs.html.
"""

from __future__ import annotations

import re

from textual.constants import ESCAPE_DELAY

SAVE_WHEEL_MODE = "\x1b[?1007s"
"""XTSAVE of the alternate scroll mode: its default differs between terminals (on in VTE, off in xterm)."""

CAPTURE_MOUSE = "\x1b[?1000;1006h\x1b[?1007l"
"""Report buttons and the wheel (1000) with decimal coordinates (1006), and switch alternate scroll off (1007).

Motion (1002, 1003) is not reported: each report would wake the input thread.
"""

RELEASE_MOUSE = "\x1b[?1000;1006l\x1b[?1007h\x1b[?1007r"
"""Undo CAPTURE_MOUSE. Terminals that know XTRESTORE end with the saved mode 1007, the others with it switched on."""

REPORT_TIMEOUT = 3.0
"""s for the rest of a report that has begun. A report of 12 bytes may arrive one byte per read, 0.2 s apart."""

MAX_REPORT = 32
"""Characters kept of an unfinished report."""

_BUTTON, _COORDINATE = r"[^\x00-\x1f]", r"[^\x00-\x20]"
"""Characters of a report in the X10 encoding: a terminal without mode 1006, such as GNU screen 4, sends it."""

_REPORT = re.compile(
    r"\x1b\[<[\d;-]*(?:[Mm]|(?=[^\d;-]))"
    rf"|\x1b\[M(?:{_BUTTON}{_COORDINATE}{{2}}|{_BUTTON}{_COORDINATE}?(?=[\x00-\x20])|(?=[\x00-\x1f]))"
)
"""A report, whole or cut short by a character that cannot be part of it; that character stays: it may be a stop key."""

_BEGUN = re.compile(rf"\x1b(?:\[(?:<[\d;-]*|M{_BUTTON}?{_COORDINATE}?)?)?\Z")
"""The beginning of a report, or of another sequence, at the end of a read."""

_PREFIX = 2
"""Characters of ESC [, with which other sequences begin, too."""


class MouseReportFilter:
    """Removes mouse reports from terminal input, wherever reads split them. The rest passes unchanged."""

    def __init__(self) -> None:
        self.removed = 0
        """Number of reports removed so far."""
        self._held = ""
        """The beginning of what may be a report."""
        self._passed = 0
        """Characters of `_held` that were returned already, because they stood alone for too long."""
        self._since = 0.0

    def feed(self, data: str, now: float) -> str:
        """Return the input without reports; the beginning of a report stays here."""
        text = self._held + data
        if self._passed:
            if _BEGUN.match(text):
                return self._hold(text, data, now)
            text = text if _REPORT.match(text) else text[self._passed :]
        self._passed = 0
        text, removed = _REPORT.subn("", text)
        self.removed += removed
        begun = _BEGUN.search(text)
        self._hold(begun.group() if begun else "", data, now)
        return text[: begun.start()] if begun else text

    def _hold(self, begun: str, data: str, now: float) -> str:
        if len(begun) <= len(data):  # it began in this read
            self._since = now
        self._held = begun if len(begun) <= MAX_REPORT else begun[: _PREFIX + 1]
        return ""

    def expire(self, now: float) -> str:
        """Return a lone ESC or ESC [ after ESCAPE_DELAY; discard a report that has not ended after REPORT_TIMEOUT."""
        waited = now - self._since
        if self._held and waited > REPORT_TIMEOUT:
            self._held, self._passed = "", 0
        if not self._passed < len(self._held) <= _PREFIX or waited < ESCAPE_DELAY:
            return ""
        alone, self._passed = self._held[self._passed :], len(self._held)
        return alone
