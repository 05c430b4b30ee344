"""`mavhelm keys`: shows what this terminal sends for keys, as bytes and as this program reads them."""

from __future__ import annotations

import codecs
import os
import select
import signal
import sys
import termios
import time
import tty
from collections.abc import Sequence
from contextlib import suppress
from types import FrameType

from groundstation.input.keymap import SPLIT, KeyEvent
from groundstation.ui.keys.keynames import format_key
from groundstation.ui.terminal.console_driver import REQUEST_KEY_RELEASES
from groundstation.ui.terminal.key_parser import UNKNOWN, KeyEventParser
from link.runtime.command_line import CommandLineParser

BEGIN = f"\x1b[?2004h\x1b[>25u{REQUEST_KEY_RELEASES}"
"""As the screen asks for keys: bracketed paste, and the kitty protocol with releases."""
END = "\x1b[=0;1u\x1b[<u\x1b[?2004l"
READ, PATIENCE = 4096, 0.05
"""Bytes of one read, and s between two looks whether a lone Escape is one."""
QUIT = ("q", "ctrl+c", "ctrl+d")


class KeyPrinter:
    """Takes the keys of one read (groundstation/ui/terminal/key_parser.py: KeySink)."""

    def __init__(self) -> None:
        self.names: list[str] = []
        self.releases = self.ended = False

    def handle_keys(self, batch: Sequence[KeyEvent]) -> None:
        """Note the names of the keys."""
        for event in batch:
            self.names.append(_describe(event))
            self.ended = self.ended or (event.key in QUIT and not event.release)

    def handle_split_keys(self, batch: Sequence[KeyEvent]) -> None:
        """Note nothing: they are in handle_keys as the rest of a sequence."""

    def handle_release_claim(self) -> None:
        """Note nothing: a release or a repeat is shown as such."""

    def handle_release_support(self) -> None:
        """Note that the terminal reports releases."""
        self.releases = True

    def handle_plain_key(self) -> None:
        """Note nothing: the key is shown as it came."""

    def close(self, reason: str) -> None:
        """Note why keys would not drive now."""
        self.names.append(reason)

    def handle_pong(self) -> None:
        """Note the answer to a ping."""
        self.names.append("answer to a ping")

    def is_repeat(self, key: str) -> bool:
        """Return False: all keys are shown."""
        return False

    def takes_text(self) -> bool:
        """Return False: Alt is shown as such."""
        return False

    def cancel_hold(self) -> None:
        """Note a report of the mouse."""
        self.names.append("mouse")


def build_parser() -> CommandLineParser:
    """Return the parser of the command line."""
    return CommandLineParser(
        prog="mavhelm keys",
        description="Show what this terminal sends for each key: bytes, and how they are read. q ends it.",
    )


def run(arguments: Sequence[str]) -> int:
    """Show keys until `q`; return the exit code."""
    parser = build_parser()
    parser.parse_args(parser.reject_empty(arguments))
    if not (sys.stdin.isatty() and sys.stdout.isatty()):
        sys.stderr.write("mavhelm: this is not a terminal: run `mavhelm keys` in one, without a pipe\n")
        return 2
    before = termios.tcgetattr(sys.stdin)
    for number in (signal.SIGTERM, signal.SIGHUP):
        signal.signal(number, _end)
    try:
        tty.setraw(sys.stdin)
        _show()
    finally:
        with suppress(OSError, termios.error):  # the terminal may be closed
            _write(END)
            termios.tcsetattr(sys.stdin, termios.TCSADRAIN, before)
    return 0


def _show() -> None:
    """Print a line for each read, until `q` or the end of the terminal."""
    printer = KeyPrinter()
    parser = KeyEventParser(printer)
    decoder = codecs.getincrementaldecoder("utf-8")("replace")
    began = time.monotonic()
    _write(f"{BEGIN}press keys; q ends\r\n")
    while not printer.ended:
        data = b""
        if select.select([sys.stdin], [], [], PATIENCE)[0]:
            data = os.read(sys.stdin.fileno(), READ)
            if not data:
                return
            list(parser.feed(decoder.decode(data)))
        else:
            list(parser.tick())
        names, printer.names = printer.names, []
        if data or names:
            _write(_line(time.monotonic() - began, data, names))
    _write(f"this terminal reports {'key releases' if printer.releases else 'no key releases'}\r\n")


def _line(at: float, data: bytes, names: Sequence[str]) -> str:
    shown = data.hex(" ")
    shown = shown if len(shown) <= 60 else f"{shown[:57]}..."
    return f"{at:8.3f} s  {shown:<24}  {', '.join(names) or '(no key)'}\r\n"


def _describe(event: KeyEvent) -> str:
    if event == SPLIT:
        return "the rest of a sequence: neutral"
    if event.key == UNKNOWN:
        return "an unknown sequence: neutral"
    return format_key(event.key) + (" released" if event.release else " repeated" if event.repeat else "")


def _write(text: str) -> None:
    os.write(sys.stdout.fileno(), text.encode())


def _end(number: int, frame: FrameType | None) -> None:
    raise SystemExit(128 + number)
