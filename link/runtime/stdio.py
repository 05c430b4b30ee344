"""Makes standard input, output and error safe to use, even if the parent process has closed them.

A closed descriptor 2 is reused by the next file that is opened, and log output would then go into a serial port, a
socket or a settings file. So each of the three that is closed is opened on /dev/null.
"""

from __future__ import annotations

import io
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
