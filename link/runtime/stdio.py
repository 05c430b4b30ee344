"""Standard input, output and error of a program, made safe to use: whoever started it may have closed them.

A closed descriptor 2 is taken by the next thing that is opened, and what is meant for the log then goes into a serial
port, a socket or a file of settings. So each of the three that is closed leads nowhere instead.
"""

from __future__ import annotations

import io
import os
import sys
from typing import TextIO


def ensure_open() -> None:
    """Call it first of all. Afterwards all three are open, and what no encoding can say is printed as an escape."""
    for number in range(3):
        try:
            os.fstat(number)
        except OSError:
            os.open(os.devnull, os.O_RDWR)  # takes the smallest number that is free: this one
    if sys.stdin is None:
        sys.stdin = open(0, closefd=False)  # noqa: SIM115
    sys.stdout = _open_text(sys.stdout, 1)
    sys.stderr = _open_text(sys.stderr, 2)
    if isinstance(sys.stdout, io.TextIOWrapper):  # file names may hold any bytes
        sys.stdout.reconfigure(errors="backslashreplace")


def _open_text(stream: TextIO | None, number: int) -> TextIO:
    return open(number, "w", closefd=False) if stream is None else stream


def discard_output() -> None:
    """Nobody reads it any more, or its disk is full: what waits to be written is lost, without a word at the end."""
    nowhere = os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, 1)
    os.close(nowhere)
