"""A terminal with bash in it, in which lines are typed as a reader types them."""

from __future__ import annotations

import fcntl
import os
import pty
import re
import select
import struct
import subprocess
import termios
import time
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

COLUMNS, LINES = 140, 45
PATIENCE = 120.0
"""s for what takes a few on an idle machine: the machine is shared."""
POLL = 0.02
"""s between two looks at who gets the keys."""
_ESCAPES = re.compile(
    r"\x1b(?:\[[0-9;?<>=!]*[ -/]*[@-~]|\][^\x07\x1b]*(?:\x07|\x1b\\)|[@-Z\\^_()][0-9A-B]?|P[^\x1b]*\x1b\\)"
)
_PROMPT = re.compile(r"<<<code (\d+)>>>")
_MORE = "<<<more>>>"


class LineError(Exception):
    """A line did not do what the page says; the text is for people."""


class StuckError(LineError):
    """Its program still runs."""


class Terminal:
    """140x45 characters. `read` is all that its programs have written."""

    def __init__(
        self, folder: Path, environment: Mapping[str, str], *, within: Sequence[str] = (), patience: float = PATIENCE
    ) -> None:
        """`within` is a command that starts the shell elsewhere; a line is waited for `patience` s."""
        self._patience = patience
        self._terminal, program = pty.openpty()
        fcntl.ioctl(program, termios.TIOCSWINSZ, struct.pack("HHHH", LINES, COLUMNS, 0, 0))
        self._raw = b""
        self._process = subprocess.Popen(
            [*within, "bash", "--norc", "--noprofile", "--noediting", "-i"],
            stdin=program,
            stdout=program,
            stderr=program,
            cwd=folder,
            env={**environment, "TERM": "xterm-256color", "PS1": "<<<code $?>>>", "PS2": _MORE},
            start_new_session=True,
            preexec_fn=_own_terminal,
        )
        os.close(program)
        self._answer(0)
        self.run("stty -echo")

    def run(self, line: str, meanwhile: Callable[[str], bool] = lambda _: False) -> tuple[str, int | None]:
        """Type a line; return what it prints and its exit code.

        The code is None when bash wants more lines, or when `meanwhile`, which is called with the text so far whenever
        there is more, returns True. Raises LineError.
        """
        start = len(self._raw)
        self.type(f"{line}\n")
        return self._answer(start, meanwhile)

    def answer(
        self, meanwhile: Callable[[str], bool] = lambda _: False, within: float | None = None
    ) -> tuple[str, int | None]:
        """Do the same for what comes from now on, within so many s (default: the patience of the terminal)."""
        return self._answer(len(self._raw), meanwhile, within)

    def type(self, keys: str) -> None:
        """Send keys to the program that runs."""
        os.write(self._terminal, keys.encode())

    def wait_for_program(self) -> None:
        """Wait until keys go to the program of the last line: before, bash takes a Ctrl-C. Raises StuckError."""
        shell = os.readlink(f"/proc/{self._process.pid}/exe")
        deadline = time.monotonic() + self._patience
        while self._foreground() == shell:
            if time.monotonic() > deadline:
                raise StuckError(f"no program within {self._patience:.0f} s")
            self.wait(POLL)

    def _foreground(self) -> str:
        """Return the path of the program that gets the keys; "" if it has ended, and others of its pipe run."""
        try:
            return os.readlink(f"/proc/{os.tcgetpgrp(self._terminal)}/exe")
        except OSError:
            return ""

    def read(self) -> str:
        """Return all that was written so far, without escape sequences."""
        while select.select([self._terminal], [], [], 0)[0] and self._read():
            pass
        return plain(self._raw)

    def close(self) -> None:
        """End the shell; what runs in it loses its terminal."""
        os.close(self._terminal)
        self._process.kill()
        self._process.wait()

    def wait(self, seconds: float) -> None:
        """Let time pass, up to the next output."""
        select.select([self._terminal], [], [], seconds)

    def _answer(
        self, start: int, meanwhile: Callable[[str], bool] = lambda _: False, within: float | None = None
    ) -> tuple[str, int | None]:
        within = self._patience if within is None else within
        deadline = time.monotonic() + within
        while True:
            text = plain(self._raw[start:])
            if prompt := _PROMPT.search(text):
                return text[: prompt.start()], int(prompt[1])
            if text.endswith(_MORE) or meanwhile(text):
                return text, None
            if not select.select([self._terminal], [], [], max(0.0, deadline - time.monotonic()))[0]:
                raise StuckError(f"no end within {within:.0f} s")
            if not self._read():
                raise StuckError("the shell has ended")

    def _read(self) -> bool:
        try:
            self._raw += (more := os.read(self._terminal, 65536))
        except OSError:
            return False
        return bool(more)


def plain(raw: bytes) -> str:
    """Return text without escape sequences and carriage returns."""
    return _ESCAPES.sub("", raw.decode(errors="replace")).replace("\r", "")


def _own_terminal() -> None:
    fcntl.ioctl(0, termios.TIOCSCTTY, 0)
