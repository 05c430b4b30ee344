"""Makes standard input, output and error safe to use, even if the parent process has closed them.

A closed descriptor 2 is reused by the next file that is opened, and log output would then go into a serial port, a
socket or a settings file. So each of the three that is closed is opened on /dev/null.
"""

from __future__ import annotations

import io
import logging
import os
import sys
from typing import TextIO


def ensure_open() -> None:
    """Open what is closed; call it first. Characters that stdout cannot encode become escapes."""
    for number in range(3):
        try:
            os.fstat(number)
        except OSError:
            os.open(os.devnull, os.O_RDWR)  # takes the smallest free number: this one
    if sys.stdin is None:
        sys.stdin = open(0, closefd=False)  # noqa: SIM115
    sys.stdout = _open_text(sys.stdout, 1)
    sys.stderr = _open_text(sys.stderr, 2)
    if isinstance(sys.stdout, io.TextIOWrapper):  # file names may contain any bytes
        sys.stdout.reconfigure(errors="backslashreplace")


def _open_text(stream: TextIO | None, number: int) -> TextIO:
    return open(number, "w", closefd=False) if stream is None else stream


def discard_output() -> None:
    """Redirect stdout to /dev/null, after a broken pipe or a full disk: the exit prints no second error."""
    nowhere = os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, 1)
    os.close(nowhere)


def escape(text: str) -> str:
    r"""Return a text with each unprintable character as Python writes it, e.g. "\x1b": no terminal obeys that."""
    return text if text.isprintable() else "".join(c if c.isprintable() else ascii(c)[1:-1] for c in text)


class PlainFormatter(logging.Formatter):
    """Formats a record with its control characters escaped: some texts come from the network.

    Further lines of a text are set in, so that none looks like a record of its own.
    """

    def formatMessage(self, record: logging.LogRecord) -> str:  # noqa: N802  # the name is logging's
        """Return the line of the record, without a traceback."""
        return "\n    ".join(map(escape, super().formatMessage(record).split("\n")))


def log_plainly(handler: logging.Handler, level: int, form: str) -> None:
    """Let all libraries log to this handler, in this form."""
    handler.setFormatter(PlainFormatter(form))
    logging.basicConfig(level=level, handlers=[handler])
