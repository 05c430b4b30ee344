"""A person at a terminal who starts the real program, arms, drives and lets go; all that it shows is recorded."""

from __future__ import annotations

import codecs
import contextlib
import fcntl
import os
import pty
import select
import subprocess
import sys
import termios
import time
from collections.abc import Callable
from functools import partial
from pathlib import Path

from tests.animation.asciicast import Cast, Output
from tests.groundstation.held_key import DELAY, GAP
from tests.waits import PATIENCE, wait_until

COLUMNS, LINES = 80, 24

ANSWERS = {"\x1b[?u": "\x1b[?31u", "\x1b[?2026$p": "\x1b[?2026;2$y", "\x1b[5n": "\x1b[0n"}
"""Request -> answer of a terminal that reports key releases and shows an update at once."""

DRIVE = (("i", 1.9), ("o", 1.3), ("i", 0.7), ("u", 1.2), ("i", 1.1))
"""Keys and how long each is held, s. The next one is pressed before one is released."""


class Shell:
    """A shell in a terminal that reports key releases, in an empty home folder."""

    def __init__(self, home: Path) -> None:
        self._terminal, program = pty.openpty()
        termios.tcsetwinsize(program, (LINES, COLUMNS))
        self._process = subprocess.Popen(
            ["/bin/sh", "-i"], cwd=home, env=_environment(home), stdin=program, stdout=program, stderr=program,
            start_new_session=True, preexec_fn=_own_terminal,
        )  # fmt: skip
        os.close(program)
        self._decoder = codecs.getincrementaldecoder("utf-8")()
        self._begin = time.monotonic()
        self._outputs: list[Output] = []
        self.shown = ""

    def cast(self) -> Cast:
        """Return what was recorded so far."""
        return Cast(COLUMNS, LINES, tuple(self._outputs))

    def look(self, seconds: float) -> None:
        """Read what is shown for so long, and answer requests."""
        deadline = time.monotonic() + seconds
        while select.select([self._terminal], [], [], max(0.0, deadline - time.monotonic()))[0]:
            text = self._decoder.decode(os.read(self._terminal, 65536))
            self._outputs.append(Output(time.monotonic() - self._begin, text))
            self.shown += text
            for request, answer in ANSWERS.items():
                self.type(answer * text.count(request))

    def wait_for(self, condition: Callable[[], bool], what: str) -> None:
        """Read until the condition; AssertionError after PATIENCE."""
        wait_until(condition, what, each=lambda: self.look(0.02))

    def type(self, keys: str) -> None:
        """Write keys as a terminal does."""
        os.write(self._terminal, keys.encode())

    def type_slowly(self, line: str) -> None:
        """Type a line for the shell as a person does."""
        for key in line:
            self.type(key)
            self.look(0.05)

    def press(self, key: str, event: int = 1) -> None:
        """Write an event of a key: 1 press, 2 repeat, 3 release (kitty keyboard protocol)."""
        code = ord(key)
        self.type(f"\x1b[{code};1:{event}u" if event == 3 else f"\x1b[{code};1:{event};{code}u")

    def hold(self, key: str, until: Callable[[], bool], *, released: str = "") -> None:
        """Hold a key down until the condition, without a release. `released`: the key that is released behind it."""
        self.press(key)
        self.look(GAP)
        if released:
            self.press(released, 3)
        self.look(DELAY - GAP)
        while not until():
            self.press(key, 2)
            self.look(GAP)

    def quit_program(self) -> None:
        """End the program by its key and wait for the prompt: until then it writes into the home folder."""
        before = len(self.shown)
        self.type("\x11")
        self.wait_for(lambda: "$ " in self.shown[before:], "the prompt after Ctrl-Q")

    def close(self) -> None:
        """Close the terminal, which ends all programs in it."""
        os.close(self._terminal)
        self._process.wait(PATIENCE)


def record(home: Path) -> Cast:
    """Record a drive of the simulated rover; `home` is an empty folder."""
    with contextlib.closing(Shell(home)) as shell:
        shell.wait_for(lambda: "$ " in shell.shown, "a prompt")
        shell.look(0.3)
        shell.type_slowly("mavhelm --sitl\r")
        shell.wait_for(lambda: "disarmed:" in shell.shown, "the Drive screen with a vehicle")
        shell.look(1.0)
        _arm(shell)
        shell.look(0.4)
        _drive(shell)
        shell.look(2.0)
        cast = shell.cast()
        shell.quit_program()
        return cast


def _arm(shell: Shell) -> None:
    deadline = time.monotonic() + PATIENCE

    def armed() -> bool:
        assert time.monotonic() < deadline, f"not armed within {PATIENCE:g} s"
        return shell.shown.rfind("hold i to drive") > shell.shown.rfind("disarmed:")

    shell.hold("r", armed)
    shell.press("r", 3)


def _drive(shell: Shell) -> None:
    before = ""
    for key, seconds in DRIVE:
        end = time.monotonic() + seconds
        shell.hold(key, partial(_passed, end), released=before)
        before = key
    shell.press(before, 3)


def _passed(moment: float) -> bool:
    return time.monotonic() >= moment


def _environment(home: Path) -> dict[str, str]:
    """Return that of a person whose shell has the virtual environment activated."""
    path = f"{Path(sys.executable).parent}:{os.environ['PATH']}"
    return {
        "HOME": str(home), "PATH": path, "PS1": "$ ", "LANG": "C.UTF-8",
        "TERM": "xterm-256color", "COLORTERM": "truecolor",
    }  # fmt: skip


def _own_terminal() -> None:
    fcntl.ioctl(0, termios.TIOCSCTTY, 0)
