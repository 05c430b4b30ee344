"""The terminal of the viewer: modes, keys and answers in, bytes out. Nothing here waits for the terminal."""

from __future__ import annotations

import asyncio
import codecs
import contextlib
import os
import termios
import tty
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from groundstation.pictures.painters import Area
from groundstation.pictures.protocol import ANSWER_WITHIN, QUERY, TerminalAnswers
from groundstation.ui.terminal.console_driver import PING
from groundstation.ui.terminal.key_parser import KeyEventParser
from groundstation.ui.terminal.tty_output import TerminalFile
from groundstation.ui.video.viewer_keys import ViewerKeys

BEGIN = "\x1b[?1049h\x1b[?25l\x1b[?7l\x1b[2J"
"""Alternate screen, no cursor, no wrap at the last column."""
END = "\x1b[0m\x1b[2J\x1b[?7h\x1b[?25h\x1b[?1049l"
READ = 4096
TICK = 0.05
"""s between two looks whether a lone Escape is one."""
SMALLEST = (2, 2)
"""Columns and rows of an area to draw in."""
FLUSH_WITHIN = 0.3
"""s that the end of the program waits for a terminal that accepts nothing."""


class PictureTerminal:
    """A terminal that is in raw mode, with one frame at most that waits to be written."""

    def __init__(self, file: TerminalFile, on_quit: Callable[[], None], on_pong: Callable[[], None]) -> None:
        self.answers = TerminalAnswers()
        self.round_trip: float | None = None
        """s of the answers; None: there was none."""
        self._answered = asyncio.Event()
        self._file, self._on_quit = file, on_quit
        self._parser = KeyEventParser(ViewerKeys(on_quit, on_pong), on_answer=self._handle_answer)
        self._decode = codecs.getincrementaldecoder("utf-8")("replace").decode
        self._waiting = b""
        self._loop = asyncio.get_running_loop()

    @property
    def busy(self) -> bool:
        """Return whether a frame still waits to be written: the next one is dropped."""
        return bool(self._waiting)

    def area(self) -> Area:
        """Return where the picture goes: all but the last row."""
        try:
            columns, rows = os.get_terminal_size(self._file.fileno())
        except OSError:
            columns, rows = 80, 24
        return Area(max(SMALLEST[0], columns), max(SMALLEST[1], rows) - 1, cell=self.answers.cell)

    def write(self, text: str) -> None:
        """Write as much as the terminal accepts now, and the rest when it accepts more."""
        self._waiting += text.encode()
        self._write_waiting()

    def write_frame(self, text: str) -> None:
        """Write a frame, and a ping whose answer says that it was read."""
        self.write(f"{text}{PING}")

    async def ask(self) -> None:
        """Ask what the terminal can show, and wait for its answers."""
        self.write(QUERY)
        began = self._loop.time()
        with contextlib.suppress(TimeoutError):
            await asyncio.wait_for(self._answered.wait(), ANSWER_WITHIN)
            self.round_trip = self._loop.time() - began

    def _handle_answer(self, answer: str) -> None:
        self.answers.handle(answer)
        if self.answers.complete:
            self._answered.set()

    @contextmanager
    def opened(self) -> Iterator[None]:
        """Read keys and draw within the block; the terminal is then as it was."""
        keyboard = self._file.keyboard
        before = termios.tcgetattr(keyboard)
        tty.setraw(keyboard)
        self._loop.add_reader(keyboard, self._read)
        self.write(BEGIN)
        try:
            yield
        finally:
            self._loop.remove_reader(keyboard)
            self._loop.remove_writer(self._file.fileno())
            self._finish()
            with contextlib.suppress(OSError, termios.error):  # the terminal may be closed
                termios.tcsetattr(keyboard, termios.TCSAFLUSH, before)

    def tick(self) -> None:
        """Handle what depends on time: a lone Escape."""
        list(self._parser.tick())

    def _read(self) -> None:
        try:
            data = os.read(self._file.keyboard, READ)
        except OSError:
            data = b""
        if not data:  # the terminal is gone
            self._loop.remove_reader(self._file.keyboard)
            self._on_quit()
        list(self._parser.feed(self._decode(data)))

    def _write_waiting(self) -> None:
        try:
            self._waiting = self._waiting[os.write(self._file.fileno(), self._waiting) :]
        except BlockingIOError:
            pass
        except OSError:
            self._waiting = b""
            self._on_quit()
        if self._waiting:
            self._loop.add_writer(self._file.fileno(), self._write_waiting)
        else:
            self._loop.remove_writer(self._file.fileno())

    def _finish(self) -> None:
        """Write what waits and END, for a short time."""
        data, descriptor = self._waiting + END.encode(), self._file.fileno()
        deadline = self._loop.time() + FLUSH_WITHIN
        with contextlib.suppress(OSError):
            while data and self._loop.time() < deadline:
                try:
                    data = data[os.write(descriptor, data) :]
                except BlockingIOError:
                    os.sched_yield()
