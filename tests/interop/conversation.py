"""A foreign program that is controlled by lines of text: what it printed, and waiting for what it must print."""

from __future__ import annotations

import os
import re
import subprocess
import threading
import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from tests.waits import PATIENCE


class Conversation:
    """A running program. A thread reads its output, so that the program never blocks."""

    def __init__(self, command: Sequence[str], folder: Path) -> None:
        self._process = subprocess.Popen(
            command,
            cwd=folder,
            env={**os.environ, "HOME": str(folder), "PYTHONUNBUFFERED": "1"},
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
        )
        self._changed = threading.Condition()
        self._heard = b""
        self._read = 0
        self._thread = threading.Thread(target=self._listen, name="conversation", daemon=True)
        self._thread.start()

    @property
    def pid(self) -> int:
        """Process id of the program."""
        return self._process.pid

    @property
    def transcript(self) -> str:
        """Return everything that it has printed."""
        return self._heard.decode(errors="replace")

    def say(self, line: str) -> None:
        """Type a line; the next `hear` searches after it."""
        assert self._process.stdin is not None
        with self._changed:
            self._read = len(self._heard)
        self._process.stdin.write(line.encode() + b"\n")
        self._process.stdin.flush()

    def hear(self, pattern: str, within: float = PATIENCE) -> re.Match[str]:
        """Wait for output that matches, since the last `say` or `hear`."""
        deadline = time.monotonic() + within
        with self._changed:
            while not (found := re.search(pattern.encode(), self._heard[self._read :])):
                left = deadline - time.monotonic()
                assert left > 0, f"not within {within} s: {pattern!r}\n{self.transcript}"
                self._changed.wait(left)
            self._read += found.end()
        match = re.search(pattern, found[0].decode())
        assert match is not None
        return match

    def wait_for(self, pattern: str, within: float = PATIENCE) -> None:
        """Wait for output that matches, since the start."""
        deadline = time.monotonic() + within
        with self._changed:
            while not re.search(pattern.encode(), self._heard):
                left = deadline - time.monotonic()
                assert left > 0, f"not within {within} s: {pattern!r}\n{self.transcript}"
                self._changed.wait(left)

    def ask(self, line: str, pattern: str, period: float = 0.5) -> None:
        """Type a line every `period` s until the answer matches."""
        deadline = time.monotonic() + PATIENCE
        while True:
            self.say(line)
            try:
                self.hear(pattern, period)
                return
            except AssertionError:
                if time.monotonic() > deadline:
                    raise

    def end(self) -> None:
        """End the program in any state."""
        end(self._process, self._thread)

    def _listen(self) -> None:
        assert self._process.stdout is not None
        while data := os.read(self._process.stdout.fileno(), 65536):
            with self._changed:
                self._heard += data
                self._changed.notify_all()


def end(process: subprocess.Popen[Any], listener: threading.Thread) -> None:
    """End a program in any state, and the thread that reads its output."""
    process.kill()
    process.wait(PATIENCE)
    listener.join(5)
    for pipe in (process.stdin, process.stdout):
        if pipe is not None:
            pipe.close()
