"""The terminal: one read of bytes is one batch of keys, with releases where it tells them. Not what keys mean.

The only module that builds on Textual's private key classes (hence the pin `textual>=8.2.8,<9`). Keys go to the sink in
the input thread, before the events go to the loop that draws: drawing never delays a key.
"""

from __future__ import annotations

import contextlib
import os
import re
import selectors
import time
from codecs import getincrementaldecoder
from collections.abc import Callable, Iterable, Sequence
from threading import Thread
from typing import Any, Protocol, cast

from textual import constants, events
from textual._keyboard_protocol import MODIFIER_FUNCTIONAL_KEYS
from textual._xterm_parser import XTermParser
from textual.app import App
from textual.drivers.linux_driver import LinuxDriver
from textual.keys import Keys, _character_to_key
from textual.message import Message

from groundstation.input.keymap import KeyEvent
from groundstation.ui.tty_output import TerminalFile

REQUEST_KEY_RELEASES = "\x1b[=31;1u\x1b[?u"
"""Kitty keyboard protocol: 1 disambiguate, 2 event types, 4 alternate keys, 8 all keys, 16 text; then "what holds?".

Written in full because some terminals mishandle the short forms (wezterm issue 7437).
"""

PING, PONG = "\x1b[5n", "\x1b[0n"
"""Device status report: every terminal answers it, so it tells whether the line to the person lives."""

READ_SIZE = 4096
SUSPEND_PATIENCE = 0.1
"""s that a suspend waits for its neutral to go out."""

SELECT_TIMEOUT = 0.1
"""Of the input thread, s: how late it may see the end of the app, or that an Escape stands alone."""

PASTE_BEGINS, PASTE_ENDS = "\x1b[200~", "\x1b[201~"
PASTE_PATIENCE = 2.0
"""s of silence in which a paste may go on. One whose end never comes would swallow every key, stops too; one that a bad
line only held up must not become keys that drive."""
LARGEST = 1000
"""Columns or rows that a terminal may claim to have: more would be drawn for minutes."""

_KEY = re.compile(r"\x1b\[(\d+)((?::\d*)*)(?:;(\d*)(?::(\d*))?)?(?:;([\d:]*))?([u~ABCDEFHPQRS])")
_REPORT = re.compile(r"\x1b\[(?:\?\d+u|\d+n|\?[\d;]*\$p)")
"""Answers to our questions; the last is Textual's question about a mode, as a bad line echoes it."""
_CUT = re.compile(r"\x1b\[[0-?]*\$?[\x00-\x1a\x1c-\x20!]")
"""A sequence without its end, then a key that is in none: Ctrl and a letter, space or "!", which are what stops."""
_PASTE = KeyEvent("paste")
"""Bound to nothing, and so a stop while driving."""
_REPEAT, _RELEASE = "2", "3"


class KeyRepeat(events.Key):
    """A key that the terminal calls an auto-repeat; to widgets it is a key like any other."""


KeyRepeat.handler_name = "on_key"


class KeyUp(Message, bubble=False):
    """A key went up."""

    def __init__(self, key: str) -> None:
        super().__init__()
        self.key = key


class TerminalClosed(Message, bubble=False):
    """The terminal is gone: nothing can be typed or shown any more."""


class KeySink(Protocol):
    """Takes what the input thread reads. Called in that thread: quick, and never on widgets."""

    def handle_keys(self, batch: Sequence[KeyEvent]) -> None:
        """The keys of one read, in order."""

    def handle_release_support(self) -> None:
        """The terminal has shown that it tells repeats and releases."""

    def close(self, reason: str) -> None:
        """Nobody is at the keys: focus lost, suspended, terminal closed."""

    def handle_pong(self) -> None:
        """The terminal answered a ping."""


class KeyEventParser(XTermParser):
    """Textual's parser that also understands repeats, releases and non-Latin layouts of the kitty protocol."""

    def __init__(self, sink: KeySink, debug: bool = False, *, clock: Callable[[], float] = time.monotonic) -> None:
        self._sink = sink
        self._clock = clock
        self._pasting = False
        self._end_of_read = ""
        self._heard = 0.0
        """When something was read last."""
        self._names: dict[str, str] = {}
        """Code of a key -> its name at the press: Shift let go before W must still give the release of "W"."""
        self._latin: dict[str, str] = {}
        """Name of a key of a non-Latin layout -> the name of the same key on a Latin one."""
        super().__init__(debug)

    def feed(self, data: str) -> Iterable[Message]:
        """The events of one read. Its keys have gone to the sink when this returns."""
        found = self._batched(super().feed(data))
        self._follow_paste(data)
        return found

    def tick(self) -> Iterable[Message]:
        """The events that only time tells: a lone Escape, and a paste without an end."""
        if self._pasting and self._clock() - self._heard > PASTE_PATIENCE:
            return self.feed(PASTE_ENDS)
        return self._batched(super().tick())

    def _follow_paste(self, data: str) -> None:
        """A paste is no key from its first moment on, and so a stop while driving."""
        self._heard = self._clock()
        seen = self._end_of_read + data
        self._end_of_read = seen[1 - len(PASTE_ENDS) :]
        before, begun, ended = self._pasting, seen.rfind(PASTE_BEGINS), seen.rfind(PASTE_ENDS)
        if begun != ended:
            self._pasting = begun > ended
        if self._pasting and not before:
            self._sink.handle_keys([_PASTE])

    def _batched(self, tokens: Iterable[Message]) -> list[Message]:
        found = [token for token in tokens if not _beyond_any_terminal(token)]
        batch = [press for token in found if (press := self._press(token)) is not None]
        if batch:
            self._sink.handle_keys(batch)
        if any(isinstance(token, events.AppBlur) for token in found):
            self._names.clear()
            self._sink.close("the terminal window has lost the focus")
        return found

    def _press(self, token: Message) -> KeyEvent | None:
        match token:
            case events.Key(key=key) | KeyUp(key=key) if key not in MODIFIER_FUNCTIONAL_KEYS:
                name = self._latin.get(key, key)
                return KeyEvent(name, repeat=isinstance(token, KeyRepeat), release=isinstance(token, KeyUp))
            case events.Paste():
                return _PASTE
        return None

    def _sequence_to_key_events(self, sequence: str, alt: bool = False) -> Iterable[events.Key]:
        if _REPORT.fullmatch(sequence):
            if sequence == PONG:
                self._sink.handle_pong()
            # "CSI ? flags u" is swallowed and not believed: Contour answers and then tells no releases. The first
            # sub-field seen is the proof.
            return [_ignored(sequence)]
        if _CUT.fullmatch(sequence):
            return self._stock(sequence[-1], alt=False)  # the stock parser would wait for 0.1 s of silence
        found = _KEY.fullmatch(sequence)
        if found is None:
            return self._stock(sequence, alt)
        code, alternates, modifiers, kind, text, end = found.groups(default="")
        if kind:
            self._sink.handle_release_support()
        if kind == _RELEASE:
            return self._released(code + end, _plain(code, modifiers, "", end), alt)
        return self._pressed(code + end, _plain(code, modifiers, text, end), alternates, kind == _REPEAT, alt)

    def _released(self, code: str, plain: str, alt: bool) -> Iterable[events.Key]:
        stock = self._stock(plain, alt)
        name = self._names.pop(code, stock[0].key if stock else Keys.Ignore)
        if name == Keys.Ignore or name in MODIFIER_FUNCTIONAL_KEYS:
            return [_ignored(plain)]
        # The caller only reads `.key` and hands the event on, so a KeyUp may stand where keys are announced.
        return [cast(events.Key, KeyUp(name))]

    def _stock(self, sequence: str, alt: bool) -> list[events.Key]:
        try:
            return list(super()._sequence_to_key_events(sequence, alt))
        except (ValueError, OverflowError):  # a sub-field where none belongs, a code point that does not exist
            return [_ignored(sequence)]

    def _pressed(self, code: str, plain: str, alternates: str, repeat: bool, alt: bool) -> Iterable[events.Key]:
        keys = self._stock(plain, alt)
        for key in keys:
            self._names[code] = key.key
            self._remember_latin(key, alternates)
        return [KeyRepeat(key.key, key.character) for key in keys] if repeat else keys

    def _remember_latin(self, key: events.Key, alternates: str) -> None:
        """On a Greek or Cyrillic layout the driver means the key's place: the layout of the base tells its letter."""
        base = alternates.split(":")[2:3]
        if base and base[0].isdecimal() and key.character is not None and not key.character.isascii():
            self._latin[key.key] = _character_to_key(chr(int(base[0])))


def _beyond_any_terminal(token: Message) -> bool:
    return isinstance(token, events.Resize) and max(token.size) > LARGEST


def _ignored(sequence: str) -> events.Key:
    """What makes the stock parser end a sequence and forget it."""
    return events.Key(Keys.Ignore, sequence)


def _plain(code: str, modifiers: str, text: str, end: str) -> str:
    """The sequence without sub-fields, as the stock parser reads it."""
    return f"\x1b[{code};{modifiers}{';' + text if text else ''}{end}"


class ConsoleDriver(LinuxDriver):
    """Textual's driver for Linux and macOS, whose keys go to the app's sink first and whose end is the app's end."""

    sink: KeySink
    terminal: TerminalFile

    def __init__(self, app: App[Any], **options: Any) -> None:
        super().__init__(app, **options)
        self._file = cast(Any, self.terminal)
        self.fileno = self.terminal.keyboard
        self.input_tty = os.isatty(self.fileno)

    @classmethod
    def bind(cls, sink: KeySink, terminal: TerminalFile) -> type[ConsoleDriver]:
        """A driver class for one app: Textual makes the driver itself and passes nothing of ours."""
        return type("BoundHelmDriver", (cls,), {"sink": sink, "terminal": terminal})

    def start_application_mode(self) -> None:
        """Also after a suspend: ask for releases again."""
        super().start_application_mode()  # type: ignore[no-untyped-call]
        if not constants.DISABLE_KITTY_KEY:
            self.write(REQUEST_KEY_RELEASES)
            self.flush()

    def _get_terminal_size(self) -> tuple[int, int]:
        """Of the terminal itself: standard output may be the log by now."""
        with contextlib.suppress(OSError):
            width, height = os.get_terminal_size(self.terminal.fileno())
            if width and height:
                return width, height
        return 80, 24

    def _sigtstp_application(self, *arguments: Any) -> None:
        # A signal handler: the main thread that it stopped may hold a lock that `shut` needs. Then the other thread
        # waits in vain, and the lease runs out instead.
        shut = Thread(target=self.sink.close, args=("the ground station was suspended",), daemon=True)
        shut.start()
        shut.join(SUSPEND_PATIENCE)
        super()._sigtstp_application(*arguments)

    def run_input_thread(self) -> None:
        """Read until the app ends or the terminal does. A copy of the stock loop that sees the end of the terminal."""
        parser = KeyEventParser(self.sink, self._debug)
        decode = getincrementaldecoder("utf-8")(errors="replace").decode
        with selectors.DefaultSelector() as selector:
            selector.register(self.fileno, selectors.EVENT_READ)
            while not self.exit_event.is_set():
                if selector.select(SELECT_TIMEOUT) and not self._read(parser, decode):
                    self.sink.close("the terminal was closed")
                    self.process_message(TerminalClosed())
                    return
                self._dispatch(parser.tick())

    def _read(self, parser: KeyEventParser, decode: Callable[[bytes], str]) -> bool:
        try:
            data = os.read(self.fileno, READ_SIZE)
        except OSError:  # EIO: the other end of the pseudo-terminal is gone
            return False
        if text := decode(data):
            self._dispatch(parser.feed(text))
        return bool(data)

    def _dispatch(self, messages: Iterable[Message]) -> None:
        for message in messages:
            self.process_message(message)
