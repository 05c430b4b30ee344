"""Key parser: the bytes of one read become one batch of key events, with releases where the terminal reports them.

With terminal.py the only module that builds on Textual's private classes (hence the pin `textual>=8.2.8,<9`). Batches
go to the sink in the input thread, before the events go to the loop that draws: drawing never delays a key.
"""

from __future__ import annotations

import re
import time
from collections.abc import Callable, Iterable, Sequence
from typing import Protocol, cast

from textual import events
from textual._keyboard_protocol import MODIFIER_FUNCTIONAL_KEYS
from textual._xterm_parser import XTermParser
from textual.keys import Keys
from textual.message import Message

from groundstation.input.keymap import KeyEvent
from groundstation.ui.mouse import MouseReportFilter

PONG = "\x1b[0n"
"""Answer to terminal.PING."""

PASTE_BEGINS, PASTE_ENDS = "\x1b[200~", "\x1b[201~"
PASTE_PATIENCE = 2.0
"""s without input during which a paste may continue.

Without a limit a paste whose end is lost would swallow every key, stop keys too; with a shorter one the rest of a paste
that a bad line delays would become keys that drive.
"""
MAX_SIZE = 1000
"""Columns or rows that a terminal may report: drawing more would take minutes."""

_KEY = re.compile(r"\x1b\[(\d+)((?::\d*)*)(?:;(\d*)(?::(\d*))?)?(?:;([\d:]*))?([u~ABCDEFHPQRS])")
_REPORT = re.compile(r"\x1b\[(?:\?\d+u|\d+n|\?[\d;]*\$p)")
"""Answers to our queries; the last is Textual's own query of a mode, as a bad line echoes it."""
_CUT = re.compile(r"\x1b\[[0-?]*\$?[\x00-\x1a\x1c-\x20!]")
"""A sequence without its end, then a key that no sequence contains: Ctrl and a letter, space or "!", the stop keys."""
_PASTE = KeyEvent("paste")
"""Not bound to any action, and so a stop key while driving."""
_REPEAT, _RELEASE = "2", "3"
_SHIFT, _CAPS_LOCK = 1, 64
_LOCKS = _CAPS_LOCK | 128
_COMMAND = 2 | 4 | 8 | 16 | 32
"""Bits of the kitty protocol's modifiers: _LOCKS with Num Lock; _COMMAND is Alt, Ctrl, Super, Hyper, Meta."""
MAX_CODE = 0x10FFFF
"""Highest code point of Unicode."""


class KeyRepeat(events.Key):
    """A key that the terminal reports as an auto-repeat; to widgets it is a key like any other."""


KeyRepeat.handler_name = "on_key"


class KeyUp(Message, bubble=False):
    """A key was released."""

    def __init__(self, key: str) -> None:
        super().__init__()
        self.key = key


class KeySink(Protocol):
    """Receives what the input thread reads; KeyGate in the program. Its methods run in that thread and return quickly.

    A protocol because the parser's tests look at the batches themselves, without a key map and a station behind them.
    """

    def handle_keys(self, batch: Sequence[KeyEvent]) -> None:
        """Handle the keys of one read, in order."""

    def handle_release_support(self) -> None:
        """Note that the terminal reports repeats and releases."""

    def close(self, reason: str) -> None:
        """Close the gate: the focus is lost, the program suspended or the terminal closed."""

    def handle_pong(self) -> None:
        """Note the answer to a ping."""

    def cancel_hold(self) -> None:
        """End the hold of a key that confirms an action: the mouse was used."""


class KeyEventParser(XTermParser):
    """Textual's parser, which also understands repeats, releases and non-Latin layouts of the kitty protocol."""

    def __init__(self, sink: KeySink, debug: bool = False, *, clock: Callable[[], float] = time.monotonic) -> None:
        self._sink = sink
        self._clock = clock
        self._mouse = MouseReportFilter()
        self._pasting = False
        self._end_of_read = ""
        self._read_at = 0.0
        """Time of the last read."""
        self._names: dict[str, str] = {}
        """Code of a key -> its name when pressed: if Shift is released before W, the release must still be of "W"."""
        super().__init__(debug)

    def feed(self, data: str) -> Iterable[Message]:
        """Return the events of one read. Its keys have gone to the sink when this returns."""
        reports = self._mouse.removed
        found = self._parse_batch(self._mouse.feed(data, self._clock()))
        if self._mouse.removed != reports:
            self._sink.cancel_hold()
        self._follow_paste(data)
        return found

    def tick(self) -> Iterable[Message]:
        """Return the events that depend on time: a lone Escape, and the end of a paste that was never closed."""
        now = self._clock()
        if self._pasting and now - self._read_at > PASTE_PATIENCE:
            return self.feed(PASTE_ENDS)
        found = self._parse_batch(alone) if (alone := self._mouse.expire(now)) else []
        if alone and self._timeout_time is not None:
            self._timeout_time = 0.0  # the filter has waited for the rest already
        return found + self._batched(super().tick())

    def _parse_batch(self, text: str) -> list[Message]:
        return self._batched(super().feed(text)) if text else []  # "" would mean the end of the input

    def _follow_paste(self, data: str) -> None:
        """Report a paste as a key from its first moment on: it is a stop key while driving."""
        self._read_at = self._clock()
        seen = self._end_of_read + data
        self._end_of_read = seen[1 - len(PASTE_ENDS) :]
        before, begun, ended = self._pasting, seen.rfind(PASTE_BEGINS), seen.rfind(PASTE_ENDS)
        if begun != ended:
            self._pasting = begun > ended
        if self._pasting and not before:
            self._sink.handle_keys([_PASTE])

    def _batched(self, tokens: Iterable[Message]) -> list[Message]:
        found = [token for token in tokens if not _is_oversized(token)]
        batch = [press for token in found if (press := self._key_event(token)) is not None]
        if batch:
            self._sink.handle_keys(batch)
        if any(isinstance(token, events.AppBlur) for token in found):
            self._names.clear()
            self._sink.close("the terminal window has lost the focus")
        return found

    def _key_event(self, token: Message) -> KeyEvent | None:
        match token:
            case events.Key(key=key) | KeyUp(key=key) if key not in MODIFIER_FUNCTIONAL_KEYS:
                return KeyEvent(key, repeat=isinstance(token, KeyRepeat), release=isinstance(token, KeyUp))
            case events.Paste():
                return _PASTE
        return None

    def _sequence_to_key_events(self, sequence: str, alt: bool = False) -> Iterable[events.Key]:
        if _REPORT.fullmatch(sequence):
            if sequence == PONG:
                self._sink.handle_pong()
            # "CSI ? flags u" is discarded: Contour answers with flags and then reports no releases. The first sub-field
            # with an event type is the proof.
            return [_ignored(sequence)]
        if _CUT.fullmatch(sequence):
            return self._parse_stock(sequence[-1], alt=False)  # the stock parser would wait for 0.1 s without input
        found = _KEY.fullmatch(sequence)
        if found is None:
            return self._parse_stock(sequence, alt)
        code, alternates, modifiers, kind, text, end = found.groups(default="")
        if kind:
            self._sink.handle_release_support()
        latin = find_latin_sequence(code, alternates, modifiers, end)
        if kind == _RELEASE:
            return self._released(code + end, latin or _plain(code, modifiers, "", end), alt)
        keys = self._parse_stock(_plain(code, modifiers, text, end), alt)
        if latin is not None:  # the key of this place, which still types its own letter
            keys = [events.Key(key.key, keys[0].character if keys else None) for key in self._parse_stock(latin, alt)]
        return self._pressed(code + end, keys, repeat=kind == _REPEAT)

    def _released(self, code: str, plain: str, alt: bool) -> Iterable[events.Key]:
        stock = self._parse_stock(plain, alt)
        name = self._names.pop(code, stock[0].key if stock else Keys.Ignore)
        if name == Keys.Ignore or name in MODIFIER_FUNCTIONAL_KEYS:
            return [_ignored(plain)]
        # The caller only reads `.key` and passes the event on, so a KeyUp may stand where keys are declared.
        return [cast(events.Key, KeyUp(name))]

    def _parse_stock(self, sequence: str, alt: bool) -> list[events.Key]:
        try:
            return list(super()._sequence_to_key_events(sequence, alt))
        except (ValueError, OverflowError):  # a sub-field where none belongs, a code point that does not exist
            return [_ignored(sequence)]

    def _pressed(self, code: str, keys: list[events.Key], *, repeat: bool) -> Iterable[events.Key]:
        for key in keys:
            self._names[code] = key.key
        return [KeyRepeat(key.key, key.character) for key in keys] if repeat else keys


def find_latin_sequence(code: str, alternates: str, modifiers: str, end: str) -> str | None:
    """Return the sequence of the same key on a Latin keyboard without Caps Lock; None where it is that already.

    On a Greek or Cyrillic layout the driver means the position of the key, with Ctrl as well, and Caps Lock changes
    nothing about it. `alternates` are ":shifted:base", base being the code of the position on a US keyboard.
    """
    base = alternates.split(":")[2:3]
    held = max(0, int(modifiers or 1) - 1)
    if end != "u" or int(code) > MAX_CODE:
        return None
    if chr(int(code)).isascii():
        if not (held & _CAPS_LOCK and chr(int(code)).isalpha()):
            return None
    elif base and base[0].isdecimal() and ord(" ") <= int(base[0]) <= ord("~"):
        code = base[0]
    else:
        return None
    letter = chr(int(code))
    typed = "" if held & _COMMAND else str(ord(letter.upper() if held & _SHIFT else letter))
    return _plain(code, str((held & ~_LOCKS) + 1), typed, end)


def _is_oversized(token: Message) -> bool:
    return isinstance(token, events.Resize) and max(token.size) > MAX_SIZE


def _ignored(sequence: str) -> events.Key:
    """Return the event that makes the stock parser end a sequence and discard it."""
    return events.Key(Keys.Ignore, sequence)


def _plain(code: str, modifiers: str, text: str, end: str) -> str:
    """Return the sequence without sub-fields, as the stock parser reads it."""
    return f"\x1b[{code};{modifiers}{';' + text if text else ''}{end}"
