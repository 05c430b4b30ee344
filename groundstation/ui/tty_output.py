"""The way out to the terminal, kept for the screen alone: what anything else prints goes to the log."""

from __future__ import annotations

import contextlib
import os
import select
import sys
import time
from collections.abc import Iterator
from pathlib import Path

_KEYBOARD, _STANDARD = 0, (1, 2)

FLUSH_POLL = 0.1
"""s between looks whether a terminal that takes nothing was given up."""

MAX_FLUSH = 0.5
"""s that a terminal may take for a frame (one is 10 kB): as long as it may be silent, see tty_ping.py."""


class TerminalFile:
    """The file that Textual draws into. A terminal that has gone away swallows the rest instead of raising."""

    def __init__(self, descriptor: int, keyboard: int) -> None:
        self.keyboard = keyboard
        """Descriptor to read keys from."""
        self._descriptor = descriptor
        self._buffer: list[str] = []
        self.gone = False
        self._flushing_since: float | None = None

    def fileno(self) -> int:
        """Of the terminal."""
        return self._descriptor

    def write(self, text: str) -> int:
        """Keep text for the next flush."""
        self._buffer.append(text)
        return len(text)

    def flush(self) -> None:
        """Write what was kept. Waits while the terminal takes nothing; the screen stands still and `stuck` says so."""
        data = "".join(self._buffer).encode("utf-8", "replace")
        self._buffer.clear()
        self._flushing_since = time.monotonic()
        while data and not self.gone:
            try:
                data = data[os.write(self._descriptor, data) :]
            except BlockingIOError:
                select.select([], [self._descriptor], [], FLUSH_POLL)
            except OSError:
                self.gone = True
        self._flushing_since = None

    def is_stuck(self, now: float) -> bool:
        """It takes nothing for a while: nobody sees what the vehicle does. `now` is of time.monotonic."""
        since = self._flushing_since
        return since is not None and now - since > MAX_FLUSH

    def isatty(self) -> bool:
        """Textual asks."""
        return not self.gone and os.isatty(self._descriptor)

    def abandon(self) -> None:
        """Give up a terminal that takes nothing any more; a flush that waits for it ends within PATIENCE."""
        self.gone = True


@contextlib.contextmanager
def redirect_output(log_file: Path | None) -> Iterator[TerminalFile]:
    """While it lasts, descriptors 1 and 2 lead to the log, and only the file given leads to the terminal."""
    sys.stdout.flush()
    sys.stderr.flush()
    saved = [os.dup(descriptor) for descriptor in _STANDARD]
    terminal = _opened_anew(next((descriptor for descriptor in saved if os.isatty(descriptor)), saved[-1]))
    log = os.open(log_file or os.devnull, os.O_WRONLY | os.O_APPEND | os.O_CREAT | os.O_CLOEXEC, 0o600)
    try:
        for descriptor in _STANDARD:
            os.dup2(log, descriptor)
        yield TerminalFile(terminal, _KEYBOARD)
    finally:
        for descriptor, old in zip(_STANDARD, saved, strict=True):
            with contextlib.suppress(OSError, ValueError):
                (sys.stdout, sys.stderr)[descriptor - 1].flush()
            os.dup2(old, descriptor)
            os.close(old)
        os.close(log)
        os.close(terminal)


def _opened_anew(descriptor: int) -> int:
    """The same terminal without blocking. Our shell shares the open file, so its own must not be changed.

    Where that is refused (a terminal of another user, after su) it blocks, and the end may be less kind (ending.py).
    """
    try:
        return os.open(os.ttyname(descriptor), os.O_WRONLY | os.O_NONBLOCK | os.O_NOCTTY | os.O_CLOEXEC)
    except OSError:
        return os.dup(descriptor)
