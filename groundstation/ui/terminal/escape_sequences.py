r"""Escape sequences: whole ones, put together from reads that split them. What is left of a split one is never a key.

A terminal sends F5 as ESC [ 1 5 ~. On a slow line these bytes come in several reads, and Textual's parser takes them
for keys after 0.1 s: "1" is a mode, "[" another screen. The grammar is that of ECMA-48 (section 5.4) and of
https://invisible-island.net/xterm/ctlseqs/ctlseqs.html. Time is an argument.
"""

from __future__ import annotations

import re

import msgspec
from textual.constants import ESCAPE_DELAY

ESC = "\x1b"

OPEN_TIME = 1.0
"""s after its newest byte for which a sequence may still be completed; what completes it then is not a key."""

MAX_LENGTH = 64
"""Characters kept of an unfinished sequence; of a longer one the beginning is kept, until it ends."""

_BUTTON, _COORDINATE = r"[^\x00-\x1f]", r"[^\x00-\x20]"
"""Characters of a mouse report in the X10 encoding: a terminal without mode 1006, such as GNU screen 4, sends it."""

_MOUSE = re.compile(r"\x1b\[[<M]")

_OPEN = re.compile(
    r"\x1b(?:"
    rf"\[(?:(?!<)[0-?]*[\"-/]*|<[\d;-]*|\[|M{_BUTTON}?|M{_BUTTON}{_COORDINATE})"
    r"|O[0-9;]*"
    r"|[\]P_^X][^\x00-\x1f]*\x1b?"
    r")?"
)
"""The beginning of a sequence. Space and "!" are not part of CSI sequences: no terminal sends them, and they stop."""

_WHOLE = re.compile(
    r"\x1b(?:"
    r"\[\d+\$"  # rxvt: a function key with Shift
    r"|\[<[\d;-]*[Mm]"
    r"|\[(?!<)[0-?]+[\"-/]*[@-Z\\-~]"
    r"|\[[\"-/]*[@-LN-Z\\-~]"
    r"|\[\[[@-~]"  # the Linux console: F1 to F5
    rf"|\[M{_BUTTON}{_COORDINATE}{{2}}"
    r"|O[0-9;]*[@-~]"
    r"|O[\"-/]"
    r"|[\]P_^X][^\x00-\x1f]*(?:\x07|\x1b\\)"
    r"|[^\[O\]P_^X\x00-\x1f]"
    r"|[\t\r\n\x08]"
    r")"
)
"""CSI and SS3 sequences, mouse reports, strings (OSC, DCS, APC, PM, SOS), and Alt with a key."""

_STRING = re.compile(r"\x1b[\]P_^X]")


def is_whole(text: str) -> bool:
    """Return whether a text is one whole sequence."""
    return _WHOLE.fullmatch(text) is not None


def is_string(text: str) -> bool:
    """Return whether a sequence is a string: terminals answer with one, and no key sends one."""
    return _STRING.match(text) is not None


class Piece(msgspec.Struct, frozen=True):
    """A part of the input."""

    text: str
    """Characters outside of sequences, one whole sequence, or a lone ESC; empty: a sequence that was given up."""
    split: bool = False
    """A sequence whose bytes came more than ESCAPE_DELAY apart, or a character in the rest of one."""

    @property
    def in_sequence(self) -> bool:
        """Return whether it is a sequence with more than the ESC."""
        return len(self.text) > 1 and self.text[0] == ESC


class SequenceAssembler:
    """Divides terminal input into characters and whole sequences, wherever reads split them. Mouse reports are none."""

    def __init__(self) -> None:
        self.mouse_reports = 0
        """Number of reports so far."""
        self._whole_reports: list[str] = []
        self._held = ""
        """The sequence that has begun."""
        self._split = False
        self._escape_passed = False
        """The ESC of `_held` stood alone for too long and was passed as the key."""
        self._read_at = 0.0
        """Time of its newest byte."""

    @property
    def waiting(self) -> bool:
        """A sequence has begun, and `expire` must be called."""
        return bool(self._held)

    def pop_reports(self) -> list[str]:
        """Return the mouse reports that came in one piece since the last call."""
        found, self._whole_reports = self._whole_reports, []
        return found

    def feed(self, data: str, now: float) -> list[Piece]:
        """Return the pieces of one read; the beginning of a sequence stays here."""
        pieces = self.expire(now)
        self._split |= bool(self._held) and now - self._read_at > ESCAPE_DELAY
        self._read_at = now
        while data:
            if self._held:
                self._take(data[0], pieces)
                data = data[1:]
                continue
            text, escape, data = data.partition(ESC)
            if text:
                pieces.append(Piece(text))
            if escape:
                self._begin(ESC)
        return pieces

    def expire(self, now: float) -> list[Piece]:
        """Return a lone ESC after ESCAPE_DELAY; give up a sequence that has not ended after OPEN_TIME."""
        waited, pieces = now - self._read_at, list[Piece]()
        if self._held == ESC and not self._escape_passed and waited > ESCAPE_DELAY:
            self._escape_passed = self._split = True
            pieces.append(Piece(ESC))
        if self._held and waited > OPEN_TIME:
            self._give_up(pieces)
        return pieces

    def _begin(self, held: str, *, split: bool = False) -> None:
        self._held, self._split, self._escape_passed = held, split, False

    def _take(self, character: str, pieces: list[Piece]) -> None:
        """Add a character to the sequence."""
        whole = self._held + character
        if is_whole(whole):
            self._report_character(character, pieces)
            self._end(whole, pieces)
        elif _OPEN.fullmatch(whole):
            self._report_character(character, pieces)
            self._held = whole if len(whole) <= MAX_LENGTH else whole[:3]
        else:
            self._cut(character, pieces)

    def _report_character(self, character: str, pieces: list[Piece]) -> None:
        """Pass a character that comes late by itself, too: a stop key stops even in the rest of a sequence."""
        if self._split and character != ESC and not _MOUSE.match(self._held):
            pieces.append(Piece(character, split=True))

    def _end(self, whole: str, pieces: list[Piece]) -> None:
        if _MOUSE.match(whole):
            self.mouse_reports += 1
            if not self._split:
                self._whole_reports.append(whole)
        else:
            pieces.append(Piece(whole, self._split))
        self._begin("")

    def _cut(self, character: str, pieces: list[Piece]) -> None:
        """End the sequence at a character that cannot be part of it; that one counts."""
        if self._held[-1] == ESC and is_string(self._held):  # the ESC in the string began another sequence
            self._begin(ESC, split=self._split)
            self._take(character, pieces)
        elif character == ESC:
            self._give_up(pieces)
            self._begin(ESC)
        else:
            if self._held == ESC:
                self._give_up(pieces)
            self.mouse_reports += _MOUSE.match(self._held) is not None
            self._begin("")
            pieces.append(Piece(character))

    def _give_up(self, pieces: list[Piece]) -> None:
        """End the sequence without its end: a key that is not known any more, or ESC."""
        if self._held == ESC:
            if not self._escape_passed:
                pieces.append(Piece(ESC))
        elif not _MOUSE.match(self._held):
            pieces.append(Piece("", split=True))
        self._begin("")
