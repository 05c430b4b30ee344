"""Exit of the UI on a signal: orderly where possible, and soon in any case."""

from __future__ import annotations

import contextlib
import os
import signal
from collections.abc import Callable, Iterator
from types import FrameType

from groundstation.ui.terminal.tty_output import TerminalFile

SIGNALS = (signal.SIGHUP, signal.SIGTERM, signal.SIGINT)

EXIT_TIMEOUT = 1.0
"""s for an orderly exit. Then a terminal that accepts no output is abandoned; after as long again the process exits.

The vehicle stops sooner: a UI that hangs loses its lease within 0.3 s (groundstation/station/driving/operator.py).
"""


@contextlib.contextmanager
def exit_on_signals(end: Callable[[int], None], terminal: TerminalFile) -> Iterator[None]:
    """Within the block, call `end` with the exit code of the signal on each of SIGNALS.

    `end` runs in a signal handler, which may interrupt the main thread at any line: it must take no lock.
    """
    overdue = 0

    def handle_signal(number: int, frame: FrameType | None) -> None:
        signal.setitimer(signal.ITIMER_REAL, EXIT_TIMEOUT, EXIT_TIMEOUT)
        end(128 + number)

    def handle_overdue(number: int, frame: FrameType | None) -> None:
        nonlocal overdue
        overdue += 1
        if overdue > 1:
            os._exit(1)  # the station notices the end of its pipe, sends neutral and exits, too
        terminal.abandon()

    before = {number: signal.signal(number, handle_signal) for number in SIGNALS}
    before[signal.SIGALRM] = signal.signal(signal.SIGALRM, handle_overdue)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        for number, handler in before.items():
            signal.signal(number, handler)
