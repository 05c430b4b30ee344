"""Terminal output reserved for the UI: what anything else prints goes to the log."""

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
"""s between checks whether a terminal that accepts no output was abandoned."""

MAX_FLUSH = 0.5
"""s that a terminal may take for a frame (10 kB): as long as it may leave a ping unanswered, see tty_ping.py."""


class TerminalFile:
    """The file that Textual draws into. Output to a terminal that is gone is discarded instead of raising.

    Textual writes in a thread of its own, because a terminal may accept nothing for a long time. One that accepts a
    frame at once gets it from the event loop: then no thread is woken, and none waits for the interpreter.
    """

    def __init__(self, descriptor: int, keyboard: int) -> None:
        self.keyboard = keyboard
        """Descriptor to read keys from."""
        self._descriptor = descriptor
        self._buffer: list[bytes] = []
        self._queued = self._taken = self._flushed = 0
        self._direct = not os.get_blocking(descriptor)
        self.gone = False
        self._flushing_since: float | None = None

    def fileno(self) -> int:
        """Return the descriptor of the terminal."""
        return self._descriptor

    def write_at_once(self, text: str) -> str | None:
        """Write as much as the terminal accepts now. Return what the thread must be given, None where nothing is left.

        In the event loop only. Without a thread that has written all it was given, nothing is written here.
        """
        rest: str | None = text
        if self._direct and self._flushed == self._queued and not self._buffer:
            data = text.encode("utf-8", "replace")
            with contextlib.suppress(OSError):  # it accepts nothing, or is gone, which the thread finds out
                data = data[os.write(self._descriptor, data) :]
            self._buffer += [data] if data else []
            rest = "" if data else None
        self._queued += rest is not None
        return rest

    def write(self, text: str) -> int:
        """Buffer what the thread was given for the next flush."""
        self._taken += 1
        return self.prepend(text)

    def prepend(self, text: str) -> int:
        """Buffer text for the next flush, which writes it before all that the thread is given later."""
        self._buffer.append(text.encode("utf-8", "replace"))
        return len(text)

    def flush(self) -> None:
        """Write the buffer. Blocks while the terminal accepts no output; `is_stuck` then becomes true."""
        data = b"".join(self._buffer)
        self._buffer.clear()
        taken = self._taken
        self._flushing_since = time.monotonic()
        while data and not self.gone:
            try:
                data = data[os.write(self._descriptor, data) :]
            except BlockingIOError:
                select.select([], [self._descriptor], [], FLUSH_POLL)
            except OSError:
                self.gone = True
        self._flushing_since = None
        self._flushed = taken

    def is_stuck(self, now: float) -> bool:
        """Return whether a flush takes too long: the operator sees an old frame. `now` is of time.monotonic."""
        since = self._flushing_since
        return since is not None and now - since > MAX_FLUSH

    def isatty(self) -> bool:
        """Return whether this is a terminal, for Textual."""
        return not self.gone and os.isatty(self._descriptor)

    def abandon(self) -> None:
        """Give up a terminal that accepts no output; a flush that waits for it ends within FLUSH_POLL."""
        self.gone = True


@contextlib.contextmanager
def redirect_output(log_file: Path | None) -> Iterator[TerminalFile]:
    """Within the block, descriptors 1 and 2 lead to the log, and only the yielded file leads to the terminal."""
    sys.stdout.flush()
    sys.stderr.flush()
    saved = [os.dup(descriptor) for descriptor in _STANDARD]
    terminal = _reopen(next((descriptor for descriptor in saved if os.isatty(descriptor)), saved[-1]))
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


def _reopen(descriptor: int) -> int:
    """Open the same terminal again without blocking: the shell shares the open file, whose mode must not change.

    Where that is refused (a terminal of another user, after su) output blocks, and the exit may be forced (exit.py).
    """
    try:
        return os.open(os.ttyname(descriptor), os.O_WRONLY | os.O_NONBLOCK | os.O_NOCTTY | os.O_CLOEXEC)
    except OSError:
        return os.dup(descriptor)
