"""The daemon's log: lines to stderr and to a file, written by a thread of its own.

Writing to a paused terminal (Ctrl-S) or a full pipe blocks. The control loop must never wait for that while wheels
turn, so it only puts lines in a queue; when the queue is full, the newest lines are lost.
"""

from __future__ import annotations

import logging
import os
import queue
import threading
from collections.abc import Callable
from functools import partial
from typing import ClassVar

from link.runtime import journald, stdio
from vehicle.runtime.log_file import LogFile

QUEUE_LINES = 1000
"""Size of the queue: more than the lines of a start and an end."""
DRAIN = 1.0
"""s that the end of the program waits for the last lines."""

_Write = Callable[[bytes], object]
"""Writes a line; may raise OSError."""


class _Brief(logging.Formatter):
    """Formats a record as one line, without traceback and control characters: some texts come from the network."""

    SEVERITIES: ClassVar = {
        logging.DEBUG: journald.DEBUG,
        logging.INFO: journald.INFO,
        logging.WARNING: journald.WARNING,
        logging.ERROR: journald.ERROR,
        logging.CRITICAL: journald.CRITICAL,
    }

    def format(self, record: logging.LogRecord) -> str:
        mark = journald.priority_prefix(self.SEVERITIES.get(record.levelno, journald.INFO))
        text = " ".join(record.getMessage().split())
        return f"{mark}vehicle: {stdio.escape(text)}"


FULL = "%(asctime)s %(levelname)s %(name)s: %(message)s"
"""Of the log file, with tracebacks."""


class _Queued(logging.Handler):
    """Puts formatted lines in the queue, with what writes them."""

    def __init__(self, lines: queue.Queue[tuple[_Write, bytes] | None], write: _Write) -> None:
        super().__init__()
        self._lines = lines
        self._write = write

    def emit(self, record: logging.LogRecord) -> None:
        try:
            self._lines.put_nowait((self._write, (self.format(record) + "\n").encode(errors="backslashreplace")))
        except queue.Full:
            return  # the newest line is lost


class DaemonLog:
    """The running log: create one first, and `close` it last."""

    def __init__(self, path: str | None = None, *, verbose: bool = False) -> None:
        """Start logging, also to the file `path` with times and tracebacks. Raises OSError if it cannot be opened."""
        self._lines: queue.Queue[tuple[_Write, bytes] | None] = queue.Queue(QUEUE_LINES)
        self._handlers = [self._handler(partial(os.write, journald.STDERR), _Brief())]
        if path is not None:
            self._handlers.append(self._handler(LogFile(path).write, stdio.PlainFormatter(FULL)))
        root = logging.getLogger()
        root.setLevel(logging.DEBUG if verbose else logging.INFO)
        for handler in self._handlers:
            root.addHandler(handler)
        self._thread = threading.Thread(target=self._write, name="log", daemon=True)
        self._thread.start()

    def close(self) -> None:
        """Write the remaining lines, for at most DRAIN s, and stop logging."""
        for handler in self._handlers:
            logging.getLogger().removeHandler(handler)
        try:
            self._lines.put(None, timeout=DRAIN)
        except queue.Full:
            return
        self._thread.join(DRAIN)

    def _handler(self, write: _Write, formatter: logging.Formatter) -> logging.Handler:
        handler = _Queued(self._lines, write)
        handler.setFormatter(formatter)
        return handler

    def _write(self) -> None:
        while (item := self._lines.get()) is not None:
            write, line = item
            try:
                write(line)
            except OSError:
                continue  # the terminal is closed or the disk is full: the error cannot be reported
