"""A client in tmux's control mode: it asks ten times a second what is on a screen, without a program for each look.

https://github.com/tmux/tmux/wiki/Control-Mode: the answer to each command is between %begin and %end, or %error. Both
have the same time and number, and the flag 1 if this client has sent the command.
"""

from __future__ import annotations

import shlex
import subprocess
import threading
from contextlib import suppress

from tests.waits import PATIENCE

OURS = b"1"
"""The flag."""


class TmuxControl:
    """Has a session of its own: a program asks who the clients of its session are."""

    def __init__(self, socket: str) -> None:
        self._process = subprocess.Popen(
            ["tmux", "-S", socket, "-C", "new-session", "cat"],
            stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL,
        )  # fmt: skip
        self._lock = threading.Lock()

    def ask(self, *words: str) -> str:
        """Run a command of tmux; return what it prints, or "" if it cannot be run or the server has ended."""
        with self._lock, suppress(BrokenPipeError):
            assert self._process.stdin is not None
            self._process.stdin.write(shlex.join(words).encode() + b"\n")
            self._process.stdin.flush()
            return self._answer()
        return ""

    def end(self) -> None:
        """Wait for its end, behind that of the server."""
        with suppress(BrokenPipeError):
            self._process.communicate(timeout=PATIENCE)

    def _answer(self) -> str:
        assert self._process.stdout is not None
        block, lines = [b""], list[bytes]()
        for line in self._process.stdout:
            words = line.split()
            if words[1:] == block:
                return b"".join(lines).decode() if words[0] == b"%end" else ""
            if words[:1] == [b"%begin"] and words[-1] == OURS:
                block, lines = words[1:], []
            else:
                lines.append(line)
        return ""
