"""Textual's terminal driver with our key parser: keys reach the key gate first, the mouse never drives.

With key_parser.py the only module that builds on Textual's private classes (hence the pin `textual>=8.2.8,<9`).
"""

from __future__ import annotations

import contextlib
import os
import selectors
import termios
import time
import weakref
from codecs import getincrementaldecoder
from collections.abc import Callable, Iterable, Iterator
from threading import Thread
from typing import Any, cast

from textual import constants
from textual.app import App
from textual.drivers.linux_driver import LinuxDriver
from textual.message import Message

from groundstation.intents.session import SUSPENDED
from groundstation.ui.terminal.key_parser import KeyEventParser, KeySink
from groundstation.ui.terminal.mouse import CAPTURE_MOUSE, RELEASE_MOUSE, SAVE_WHEEL_MODE
from groundstation.ui.terminal.tty_output import TerminalFile

REQUEST_KEY_RELEASES = "\x1b[=31;1u\x1b[?u"
"""Kitty keyboard protocol: set all flags (1 disambiguate, 2 event types, 4 alternate keys, 8 all keys, 16 text), then
query them. Written in full because some terminals mishandle the short forms (wezterm issue 7437)."""

PING = "\x1b[5n"
"""Device status report request (DSR 5). Every terminal answers, so the answer shows that the line to the user works."""

READ_SIZE = 4096
ABANDONED = f"{RELEASE_MOUSE}\x1b[<u\x1b[?2004l\x1b[?2048l\x1b[?1004l\x1b[?7h\x1b[?1049l\x1b[?25h"
"""Undoes what a killed program left switched on: mouse, kitty keys, pastes, focus, wrap, alternate screen, cursor."""

SUSPEND_PATIENCE = 0.1
"""s that a suspend waits for its neutral demand to be sent."""

ANSWER_PATIENCE = 0.1
"""s that the end of the program waits for the answer to the last ping."""

SELECT_TIMEOUT = 0.1
"""Longest wait of the input thread, s, while a lone Escape or the end of a paste may have to be noticed."""


class TerminalClosed(Message, bubble=False):
    """The terminal is gone: no input and no output any more."""


class ConsoleDriver(LinuxDriver):
    """Textual's driver for Linux and macOS that passes keys to a sink first and ends the app with the terminal."""

    sink: KeySink
    terminal: TerminalFile
    awaits_answer: Callable[[], bool]
    """Return whether the terminal, which answers pings, has not answered the last one. Called from any thread."""
    take_answer: Callable[[str], None]
    """Takes each answer of the terminal that is no key, in the input thread."""

    def __init__(self, app: App[Any], **options: Any) -> None:
        super().__init__(app, **options)
        self._lent = False
        self._end_signal, self._end_sender = os.pipe()
        weakref.finalize(self, _close, self._end_signal, self._end_sender)
        self._file = cast(Any, self.terminal)
        self.fileno = self.terminal.keyboard
        self.input_tty = os.isatty(self.fileno)

    @classmethod
    def bind(
        cls,
        sink: KeySink,
        terminal: TerminalFile,
        awaits_answer: Callable[[], bool] = lambda: False,
        take_answer: Callable[[str], None] = lambda _: None,
    ) -> type[ConsoleDriver]:
        """Return a driver class for one app: Textual creates the driver itself and passes no arguments of ours."""
        bound = {
            "sink": sink,
            "terminal": terminal,
            "awaits_answer": staticmethod(awaits_answer),
            "take_answer": staticmethod(take_answer),
        }
        return type("BoundConsoleDriver", (cls,), bound)

    def start_application_mode(self) -> None:
        """Set up the terminal, also after a suspend, and request key releases."""
        self.terminal.prepend(SAVE_WHEEL_MODE)  # before the stock method, which captures the mouse twice
        super().start_application_mode()  # type: ignore[no-untyped-call]
        if not constants.DISABLE_KITTY_KEY:
            self.write(REQUEST_KEY_RELEASES)
            self.flush()

    @contextlib.contextmanager
    def lend(self) -> Iterator[Callable[[bool], None]]:
        """Draw nothing within the block, for another program in this terminal; within App.suspend only.

        Call what is yielded with whether that program has left in order. If not, the modes are restored for it.
        """
        self._lent, clean = True, False
        modes = termios.tcgetattr(self.fileno)

        def note(in_order: bool) -> None:
            nonlocal clean
            clean = in_order

        try:
            yield note
        finally:
            if not clean:
                self.terminal.prepend(ABANDONED)
                self.terminal.flush()
            with contextlib.suppress(termios.error):
                termios.tcsetattr(self.fileno, termios.TCSAFLUSH, modes)
            self._lent = False

    @property
    def reads(self) -> bool:
        """The input thread runs. What the terminal answers after it has ended is typed into the shell."""
        return self._key_thread is not None and self._key_thread.is_alive()

    def write(self, data: str) -> None:
        """Write to the terminal, unless it is lent."""
        if not self._lent and (rest := self.terminal.write_at_once(data)) is not None:
            super().write(rest)

    def send_message(self, message: Message) -> None:
        """Post a message to the app, from any thread. The stock method makes a task and two futures for each key."""
        self._app.post_message(message)

    def _enable_mouse_support(self) -> None:
        """Capture the mouse on each start. The app runs with `mouse=False`: Textual gets no event of the mouse."""
        self.write(CAPTURE_MOUSE)
        self.flush()

    def _disable_mouse_support(self) -> None:
        """Release the mouse on each end: exit, crash, signal and suspend."""
        self.write(RELEASE_MOUSE)
        self.flush()

    def _get_terminal_size(self) -> tuple[int, int]:
        """Return the size of the terminal itself: standard output may lead to the log by now."""
        with contextlib.suppress(OSError):
            width, height = os.get_terminal_size(self.terminal.fileno())
            if width and height:
                return width, height
        return 80, 24

    def _sigtstp_application(self, *arguments: Any) -> None:
        # A signal handler: the interrupted main thread may hold a lock that `close` needs. The other thread then waits
        # in vain, and the lease expires instead.
        closing = Thread(target=self.sink.close, args=(SUSPENDED,), daemon=True)
        closing.start()
        closing.join(SUSPEND_PATIENCE)
        super()._sigtstp_application(*arguments)

    def disable_input(self) -> None:
        """End the input thread, which waits for keys without a limit.

        It reads the answer to the last ping first: one that comes later is typed into the shell.
        """
        if self._key_thread is not None and self._key_thread.is_alive():
            deadline = time.monotonic() + ANSWER_PATIENCE
            while self.awaits_answer() and time.monotonic() < deadline:
                time.sleep(ANSWER_PATIENCE / 20)
        os.write(self._end_sender, b"x")
        super().disable_input()
        os.read(self._end_signal, 1)

    def run_input_thread(self) -> None:
        """Read until the app or the terminal ends. The stock loop does not notice the end of the terminal."""
        parser = KeyEventParser(self.sink, self._debug, on_answer=self.take_answer)
        decode = getincrementaldecoder("utf-8")(errors="replace").decode
        with selectors.DefaultSelector() as selector:
            for descriptor in (self.fileno, self._end_signal):
                selector.register(descriptor, selectors.EVENT_READ)
            while not self.exit_event.is_set():
                ready = {key.fd for key, _ in selector.select(SELECT_TIMEOUT if parser.waiting else None)}
                if self._end_signal in ready:
                    self.exit_event.wait(SELECT_TIMEOUT)
                elif ready and not self._read(parser, decode):
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


def _close(*descriptors: int) -> None:
    for each in descriptors:
        os.close(each)
