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
from textual._ansi_sequences import ANSI_SEQUENCES_KEYS
from textual._keyboard_protocol import FUNCTIONAL_KEYS, MODIFIER_FUNCTIONAL_KEYS
from textual._xterm_parser import XTermParser
from textual.keys import Keys
from textual.message import Message

from groundstation.input.keymap import SPLIT, KeyEvent
from groundstation.ui.terminal.escape_sequences import ESC, Piece, SequenceAssembler, is_string, is_whole
from groundstation.ui.terminal.mouse import parse_report

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
_REPORT = re.compile(r"\x1b\[(?:\?\d+u|\??\d+n|[?>=][\d;]*c|\??[\d;]*\$[py]|[\d;]*t)")
"""Answers of terminals: to our queries, and others. "$p" is Textual's own query of a mode, as a bad line echoes it."""
_FLAGS = re.compile(r"\x1b\[\?(\d{1,3})u")
_EVENT_TYPES = 2
"""Bit of the flags of the kitty protocol that are set."""
_MODE_REPORT = re.compile(r"\x1b\[\?\d+;\d\$y")
"""The answer to that query, which the stock parser reads."""
_PASTE, UNKNOWN = KeyEvent("paste"), "unknown_sequence"
"""Not bound to any action, and so stop keys while driving."""
LONGEST = 32
"""Characters of a sequence; the stock parser takes a longer one for keys."""
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

    def handle_split_keys(self, batch: Sequence[KeyEvent]) -> None:
        """Handle keys from the rest of an escape sequence that a slow line has split: only a stop key counts."""

    def is_repeat(self, key: str) -> bool:
        """Return whether the event loop need not see this key, which was handled."""

    def handle_release_claim(self) -> None:
        """Note that the terminal says that it reports repeats and releases, which is no proof."""

    def handle_release_support(self) -> None:
        """Note that the terminal reports repeats and releases."""

    def handle_plain_key(self) -> None:
        """Note that a key came as plain text, of which no release follows, although the terminal has reported some."""

    def close(self, reason: str) -> None:
        """Close the gate: the focus is lost, the program suspended or the terminal closed."""

    def handle_pong(self) -> None:
        """Note the answer to a ping."""

    def takes_text(self) -> bool:
        """Return whether a text field has the keys."""

    def cancel_hold(self) -> None:
        """End the hold of a key that confirms an action: the mouse was used."""


class KeyEventParser(XTermParser):
    """Textual's parser, which also understands repeats, releases and non-Latin layouts of the kitty protocol."""

    def __init__(
        self,
        sink: KeySink,
        debug: bool = False,
        *,
        clock: Callable[[], float] = time.monotonic,
        on_answer: Callable[[str], None] = lambda _: None,
    ) -> None:
        """`on_answer` gets each whole sequence that is an answer of the terminal and no key."""
        self._sink, self._on_answer = sink, on_answer
        self._clock = clock
        self._sequences = SequenceAssembler()
        self._mouse_reports = 0
        self._pasting = False
        self._proved = False
        """The newest key had an event type."""
        self._read_at = 0.0
        """Time of the last read with more than an answer to a ping."""
        self._names: dict[str, str] = {}
        """Code of a key -> its name when pressed: if Shift is released before W, the release must still be of "W"."""
        super().__init__(debug)

    def feed(self, data: str) -> Iterable[Message]:
        """Return the events of one read. Its keys have gone to the sink when this returns."""
        now = self._clock()
        pieces = self._sequences.feed(data, now)
        if any(piece.text != PONG for piece in pieces):  # answers to pings go on for ever, and are not text
            self._read_at = now
        return self._handle(pieces)

    @property
    def waiting(self) -> bool:
        """Something depends on time, and `tick` must be called."""
        return self._pasting or self._sequences.waiting

    def tick(self) -> Iterable[Message]:
        """Return the events that depend on time: a lone Escape, and the end of a paste that was never closed."""
        now = self._clock()
        if self._pasting and now - self._read_at > PASTE_PATIENCE:
            return self.feed(PASTE_ENDS)
        return self._handle(self._sequences.expire(now))

    def _handle(self, pieces: Iterable[Piece]) -> list[Message]:
        """Return the events of one read, without repeats, after its keys have gone to the sink as one batch."""
        found, batch = list[Message](), list[KeyEvent]()
        for piece in pieces:
            self._note_plain_text(piece)
            keys = [_PASTE] if piece.text == PASTE_BEGINS and not self._pasting else []
            tokens = [token for token in self._parse(piece) if not _is_oversized(token)]
            keys += [press for token in tokens if (press := self._key_event(token)) is not None]
            if piece.split:
                keys = self._handle_split(piece, keys)
                tokens = [token for token in tokens if not isinstance(token, events.Key)]
            batch += (press for press in keys if press != _PASTE or press not in batch)
            found += tokens
        self._tell(found, batch)
        found += (report for text in self._sequences.pop_reports() if (report := parse_report(text)) is not None)
        return [token for token in found if not (isinstance(token, events.Key) and self._sink.is_repeat(token.key))]

    def _note_plain_text(self, piece: Piece) -> None:
        """Tell that a character is a key without a release.

        Terminals without flag 8 report releases of arrows only, and an input method sends text without a key.
        """
        if self._proved and not self._pasting and not piece.split and piece.text[:1] not in ("", ESC):
            self._proved = False
            self._sink.handle_plain_key()

    def _tell(self, found: Iterable[Message], batch: Sequence[KeyEvent]) -> None:
        if self._mouse_reports != self._sequences.mouse_reports:
            self._mouse_reports = self._sequences.mouse_reports
            self._sink.cancel_hold()
        if batch:
            self._sink.handle_keys(batch)
        if any(isinstance(token, events.AppBlur) for token in found):
            self._names.clear()
            self._sink.close("the terminal window has lost the focus")

    def _parse(self, piece: Piece) -> Iterable[Message]:
        """Return what the stock parser makes of a piece; it never gets a part of a sequence."""
        text = piece.text
        if text in (PASTE_BEGINS, PASTE_ENDS):
            self._pasting = text == PASTE_BEGINS
        elif self._pasting and (piece.split or text[:1] == ESC):
            return []  # the stock parser would take what follows a sequence in a paste for keys
        elif text == ESC:
            return [events.Key("escape", ESC)]
        elif len(text) == 1 and text.isascii() and text.isalnum() and not self._pasting:
            return [events.Key(text, text)]  # what the stock parser makes of it, sooner
        elif piece.in_sequence and (parsed := self._parse_at_once(text)) is not None:
            return parsed
        return list(super().feed(text)) if text else []

    def _parse_at_once(self, sequence: str) -> list[Message] | None:
        """Return the events of a sequence for whose end the stock parser would wait; None for all others."""
        if is_string(sequence):
            self._on_answer(sequence)
            return []
        if len(sequence) > LONGEST and _REPORT.fullmatch(sequence):  # the attributes of xterm and VTE
            self._handle_report(sequence)
            return []
        if len(sequence) > LONGEST:
            return list(self._unknown(sequence))
        if len(sequence) == 2 and sequence[1].isprintable() and self._sink.takes_text():
            # Alt types nothing into a text: it is ESC and the next key, which tmux holds back for its escape-time.
            return [events.Key("escape", ESC), *super().feed(sequence[1])]
        if len(sequence) == 2 and not self._parse_stock(sequence, alt=False):
            return [_with_alt(key) for key in self._parse_stock(sequence[1], alt=True)]
        return None

    def _handle_split(self, piece: Piece, keys: Sequence[KeyEvent]) -> list[KeyEvent]:
        """Pass stop keys and releases of a split sequence; any other key in it is not a key, but neutral."""
        self._sink.handle_split_keys([press for press in keys if not press.release])
        if self._pasting or len(piece.text) == 1 or (piece.text and not keys):
            return []
        return [*(press for press in keys if press.release), SPLIT]

    def _key_event(self, token: Message) -> KeyEvent | None:
        match token:
            case events.Key(key=key) | KeyUp(key=key) if key not in MODIFIER_FUNCTIONAL_KEYS:
                return KeyEvent(key, repeat=isinstance(token, KeyRepeat), release=isinstance(token, KeyUp))
            case events.Paste():
                return _PASTE
        return None

    def _sequence_to_key_events(self, sequence: str, alt: bool = False) -> Iterable[events.Key]:
        if _REPORT.fullmatch(sequence) and not _MODE_REPORT.fullmatch(sequence):
            self._handle_report(sequence)
            return [_ignored(sequence)]
        found = _KEY.fullmatch(sequence)
        if found is None:
            return self._parse_stock(sequence, alt) or self._unknown(sequence)
        code, alternates, modifiers, kind, text, end = found.groups(default="")
        if end != "u" and code + end not in FUNCTIONAL_KEYS:  # F19, "33~": the stock parser takes 33 for "!"
            names = ANSI_SEQUENCES_KEYS.get(sequence)
            return (
                [events.Key(name.value, None) for name in names]
                if isinstance(names, tuple)
                else self._unknown(sequence)
            )
        if kind:
            self._proved = True
            self._sink.handle_release_support()
        latin = find_latin_sequence(code, alternates, modifiers, end)
        if kind == _RELEASE:
            return self._released(code + end, latin or _plain(code, modifiers, "", end), alt)
        keys = self._parse_stock(_plain(code, modifiers, text, end), alt)
        if latin is not None:  # the key of this place, which still types its own letter
            keys = [events.Key(key.key, keys[0].character if keys else None) for key in self._parse_stock(latin, alt)]
        return self._pressed(code + end, keys, repeat=kind == _REPEAT)

    def _handle_report(self, report: str) -> None:
        """Handle the answer of a terminal.

        "CSI ? flags u" is shown, and timers go on: Contour answers with flags and then reports no releases. The first
        sub-field with an event type is the proof.
        """
        if report == PONG:
            self._sink.handle_pong()
        self._on_answer(report)
        if (flags := _FLAGS.fullmatch(report)) and int(flags[1]) & _EVENT_TYPES:
            self._sink.handle_release_claim()

    def _unknown(self, sequence: str) -> list[events.Key]:
        """Return a key without a meaning; its last character may be a stop key behind a sequence without its end."""
        if not is_whole(sequence) or _MODE_REPORT.fullmatch(sequence):
            return []
        self._sink.handle_split_keys([KeyEvent(key.key) for key in self._parse_stock(sequence[-1], alt=False)])
        return [events.Key(UNKNOWN, None)]

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


def _with_alt(key: events.Key) -> events.Key:
    """Return the key as Alt and this key; Space and "!" stop with Alt as well."""
    if "+" in key.key or key.character in (" ", "!"):
        return key
    return events.Key(f"alt+{key.key}", None)


def _ignored(sequence: str) -> events.Key:
    """Return the event that makes the stock parser end a sequence and discard it."""
    return events.Key(Keys.Ignore, sequence)


def _plain(code: str, modifiers: str, text: str, end: str) -> str:
    """Return the sequence without sub-fields, as the stock parser reads it."""
    return f"\x1b[{code};{modifiers}{';' + text if text else ''}{end}"
