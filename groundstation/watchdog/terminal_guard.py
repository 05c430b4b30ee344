"""A process that resets the terminal of a screen which is killed, where no watchdog of a station does."""

from __future__ import annotations

import contextlib
import os
import signal
from collections.abc import Iterator

from groundstation.watchdog.terminal_reset import LAST_TRY, TerminalReset


@contextlib.contextmanager
def guard_terminal(path: str | None) -> Iterator[None]:
    """Reset the terminal if this process is killed meanwhile. Call before there is any thread. Raises OSError."""
    reset = TerminalReset(path)
    theirs, ours = os.pipe()
    process = os.fork()
    if not process:
        os.close(ours)
        _watch(theirs, reset)
    os.close(theirs)
    try:
        yield
    finally:
        with contextlib.suppress(BrokenPipeError):  # the guard was killed
            os.write(ours, b"\0")
        os.close(ours)
        os.waitpid(process, 0)


def _watch(pipe: int, reset: TerminalReset) -> None:
    """Wait for the end of the screen's process, which says so unless it is killed. Does not return."""
    try:
        os.setsid()
        signal.signal(signal.SIGHUP, signal.SIG_IGN)
        if not os.read(pipe, 1):
            reset.insist(LAST_TRY)
    finally:
        os._exit(0)
