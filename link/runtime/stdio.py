"""Makes standard input, output and error safe to use, even if the parent process has closed them.

A closed descriptor 2 is reused by the next file that is opened, and log output would then go into a serial port, a
socket or a settings file. So each of the three that is closed is opened on /dev/null.
"""

from __future__ import annotations

import io
import logging
import os
import select
import signal
import sys
from collections.abc import Callable
from typing import TextIO

READER_GONE = 128 + signal.SIGPIPE
"""Exit code of a program whose reader has gone, as `head` does: that of a program which the signal ends."""
OUTPUT_FAILED = 1
"""Exit code of a program whose output could not be written."""


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


def end_output(error: OSError, tell: Callable[[str], object]) -> int:
    """Return the exit code after a failed output; `tell` gets the reason, unless it is a reader that has gone.

    stdout is /dev/null from now on: the exit prints no second error.
    """
    nowhere = os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, 1)
    os.close(nowhere)
    if isinstance(error, BrokenPipeError):
        return READER_GONE
    tell(error.strerror or str(error))
    return OUTPUT_FAILED


def run_program(program: str, run: Callable[[], int]) -> int:
    """Run a program and write what it has printed; return its exit code. Raises SystemExit as argparse does."""
    try:
        code = run()
        return _flush(program) or code
    except SystemExit as end:
        end.code = _flush(program) or end.code
        raise
    except BrokenPipeError as error:
        if not _reader_has_gone():
            raise  # it is another pipe
        return end_output(error, lambda _: None)


def _flush(program: str) -> int:
    """Write what is buffered; return 0, or the exit code if that fails."""
    try:
        sys.stdout.flush()
    except OSError as error:
        return end_output(error, lambda reason: sys.stderr.write(f"{program}: output: {reason}\n"))
    return 0


def _reader_has_gone() -> bool:
    poll = select.poll()
    poll.register(1, select.POLLOUT)  # macOS reports nothing where nothing is waited for
    return any(events & (select.POLLERR | select.POLLHUP) for _, events in poll.poll(0))


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
