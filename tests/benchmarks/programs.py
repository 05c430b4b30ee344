"""Real programs on real terminals and pipes, started for a measurement and ended with it."""

from __future__ import annotations

import fcntl
import os
import pty
import re
import socket
import struct
import subprocess
import sys
import tempfile
import termios
import time
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path

from tests.benchmarks.figures import BenchmarkError
from tests.benchmarks.machine import ROOT
from tests.benchmarks.watch import Watch

PING, PONG = b"\x1b[5n", b"\x1b[0n"
"""Device status report and its answer: a terminal answers, and the ground station asks four times a second."""

KEPT = 200_000
"""Bytes of output that are kept."""

_STATE = tempfile.TemporaryDirectory(prefix="mavhelm-bench-state-")

END_WITHIN = 5.0
"""s in which a program must end after SIGTERM."""

_CONTROL = re.compile(rb"\x1b(?:\[[0-9:;<=>?]*[ -/]*[@-~]|\][^\x07\x1b]*(?:\x07|\x1b\\)|[@-Z\\-_])")


class Program:
    """One running process whose output is read while the watch waits."""

    def __init__(
        self, watch: Watch, argv: Sequence[str], terminal: int, program_end: int, *, pty_session: bool
    ) -> None:
        self._watch = watch
        self._terminal = terminal
        self._output = bytearray()
        self.received = 0
        """Bytes of output so far."""
        self._tail = b""
        os.set_blocking(terminal, False)
        self.started = time.monotonic()
        self.process = subprocess.Popen(
            argv,
            stdin=program_end if pty_session else subprocess.DEVNULL,
            stdout=program_end,
            stderr=program_end,
            start_new_session=True,
            preexec_fn=_own_terminal if pty_session else None,
            cwd=ROOT,
            env=_environment(),
        )
        os.close(program_end)
        watch.add(terminal, self._read)
        self._end = os.pidfd_open(self.process.pid)  # readable when the process has ended, which wakes the watch
        watch.add(self._end, lambda: False)

    @property
    def pid(self) -> int:
        """Process id of the program; it may have children."""
        return self.process.pid

    @property
    def text(self) -> str:
        """Return its latest output, without control sequences."""
        return _CONTROL.sub(b"", bytes(self._output)).decode("utf-8", "replace")

    def text_since(self, received: int) -> str:
        """Return the output after so many bytes, without control sequences."""
        new = self.received - received
        return _CONTROL.sub(b"", bytes(self._output[-new:] if new else b"")).decode("utf-8", "replace")

    def type(self, keys: bytes) -> int:
        """Write keys to its terminal; return the time just before, CLOCK_MONOTONIC ns."""
        stamp = time.monotonic_ns()
        os.write(self._terminal, keys)
        return stamp

    def wait_for(self, word: str, within: float) -> float:
        """Wait for a word in its output; return the s since the start. Raises BenchmarkError."""
        if not self._watch.until(lambda: word in self.text or self.process.poll() is not None, within):
            raise BenchmarkError(f"{self.name}: no {word!r} within {within:g} s; it says {self.text[-300:]!r}")
        if word not in self.text:
            raise BenchmarkError(f"{self.name} ended with {self.process.poll()}: {self.text[-300:]!r}")
        return time.monotonic() - self.started

    @property
    def name(self) -> str:
        """For messages."""
        return " ".join(map(str, self.process.args[1:4])) if isinstance(self.process.args, list) else "program"

    def end(self) -> None:
        """Send SIGTERM, wait, send SIGKILL."""
        if self.process.poll() is None:
            self.process.terminate()
        if not self._watch.until(lambda: self.process.poll() is not None, END_WITHIN):
            self.process.kill()
            self.process.wait()
        for descriptor in (self._terminal, self._end):
            self._watch.remove(descriptor)
            os.close(descriptor)

    def _read(self) -> bool:
        try:
            data = os.read(self._terminal, 65536)
        except BlockingIOError:
            return True
        except OSError:  # EIO: the program has closed its end of the pty
            return False
        self._output += data
        self.received += len(data)
        del self._output[:-KEPT]
        self._answer(data)
        return bool(data)

    def _answer(self, data: bytes) -> None:
        """Answer as a terminal would. The end of a read may cut a query, but no suffix of one starts another."""
        seen = self._tail + data
        for _ in range(seen.count(PING)):
            os.write(self._terminal, PONG)
        self._tail = seen[-len(PING) + 1 :]


def on_terminal(watch: Watch, argv: Sequence[str], columns: int, lines: int) -> Program:
    """Start a program that owns a pseudo-terminal of this size."""
    terminal, program_end = pty.openpty()
    fcntl.ioctl(program_end, termios.TIOCSWINSZ, struct.pack("HHHH", lines, columns, 0, 0))
    return Program(watch, argv, terminal, program_end, pty_session=True)


def on_pipe(watch: Watch, argv: Sequence[str]) -> Program:
    """Start a program without a terminal; its output comes through a pipe."""
    ours, theirs = os.pipe()
    return Program(watch, argv, ours, theirs, pty_session=False)


def python(module: str, *arguments: str) -> list[str]:
    """Return the command for a module, with our interpreter."""
    return [sys.executable, "-m", module, *arguments]


def free_port() -> int:
    """Return a UDP port on loopback that is free now."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sock:
        sock.bind(("127.0.0.1", 0))
        return int(sock.getsockname()[1])


@contextmanager
def scratch() -> Iterator[Path]:
    """Create a folder that exists as long as a measurement."""
    with tempfile.TemporaryDirectory(prefix="mavhelm-bench-") as name:
        yield Path(name)


def _own_terminal() -> None:
    """Make the terminal on standard input the controlling terminal of the session, as in a terminal window (in the
    child)."""
    fcntl.ioctl(0, termios.TIOCSCTTY, 0)


def _environment() -> Mapping[str, str]:
    """Return our environment, with a plain terminal of the size of the pty, with byte code caches as on a user's
    machine, and with a state folder of their own, where sessions are recorded."""
    left_out = ("COLUMNS", "LINES", "PYTHONDONTWRITEBYTECODE")
    kept = {name: value for name, value in os.environ.items() if name not in left_out}
    return kept | {"TERM": "xterm-256color", "PYTHONUNBUFFERED": "1", "XDG_STATE_HOME": _STATE.name}
