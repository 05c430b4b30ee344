"""How the screen ends when it is told to from outside: in order where it can, and in any case soon."""

from __future__ import annotations

import contextlib
import os
import signal
from collections.abc import Callable, Iterator
from types import FrameType

from groundstation.ui.tty_output import TerminalFile

SIGNALS = (signal.SIGHUP, signal.SIGTERM, signal.SIGINT)

EXIT_TIMEOUT = 1.0
"""s for an orderly end; after it a terminal that takes no output is given up, after as much again everything.

The vehicle does not wait for either: a screen that hangs loses its lease within 0.3 s (groundstation/station/operator.py).
"""


@contextlib.contextmanager
def exit_on_signals(end: Callable[[int], None], terminal: TerminalFile) -> Iterator[None]:
    """While it lasts, each of SIGNALS calls `end` with the exit code of that signal.

    `end` is called inside a signal handler of the main thread, which may stop any line: it must take no lock.
    """
    overdue = 0

    def told(number: int, frame: FrameType | None) -> None:
        signal.setitimer(signal.ITIMER_REAL, EXIT_TIMEOUT, EXIT_TIMEOUT)
        end(128 + number)

    def late(number: int, frame: FrameType | None) -> None:
        nonlocal overdue
        overdue += 1
        if overdue > 1:
            os._exit(1)  # the station sees the end of its pipe, sends neutral and ends too
        terminal.abandon()

    before = {number: signal.signal(number, told) for number in SIGNALS}
    before[signal.SIGALRM] = signal.signal(signal.SIGALRM, late)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        for number, handler in before.items():
            signal.signal(number, handler)
