"""The real screen as a process on a pseudo-terminal of its own, with a station that only records."""

from __future__ import annotations

import contextlib
import os
import pty
import select
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

from textual.drivers.linux_driver import LinuxDriver

from groundstation.intents.session import RenewLease
from groundstation.intents.union import AnyIntent
from groundstation.intents.watch import Watch
from groundstation.ui.app.run import run
from groundstation.ui.terminal.console_driver import ConsoleDriver
from tests.groundstation.ui.examples import Recorder, snapshot
from tests.groundstation.ui.ptys import STANDARD

LIMIT = 60.0
"""s for what takes half a second."""

FOLDER = Path(__file__).parents[3]


class Program:
    """The screen on a pseudo-terminal."""

    def __init__(self, report: Path, *options: str) -> None:
        self.master, self.slave = pty.openpty()
        self.report = report
        self.drawn = b""
        self.process = subprocess.Popen(
            [sys.executable, "-m", __name__, str(report), *options],
            stdin=self.slave, stdout=self.slave, stderr=self.slave, cwd=FOLDER, start_new_session=True,
        )  # fmt: skip

    @classmethod
    @contextlib.contextmanager
    def running(cls, report: Path, *, crash: bool = False) -> Iterator[Program]:
        """Start it, and end it with the block."""
        made = cls(report, *(["--crash"] if crash else []))
        try:
            yield made
        finally:
            made.process.kill()
            made.process.wait()
            for descriptor in (made.master, made.slave):
                with contextlib.suppress(OSError):
                    os.close(descriptor)

    def read_until(self, wanted: bytes, start: int = 0) -> None:
        """Read what is drawn until it holds the bytes behind `start`."""
        deadline = time.monotonic() + LIMIT
        while self.drawn.find(wanted, start) < 0:
            assert time.monotonic() < deadline, self.drawn[-2000:]
            if select.select([self.master], [], [], 0.1)[0]:
                self.drawn += os.read(self.master, 1 << 16)

    def is_stopped(self) -> bool:
        """Wait until the process is stopped, as by Ctrl-Z."""
        pid, status = os.waitpid(self.process.pid, os.WUNTRACED)
        return pid == self.process.pid and os.WIFSTOPPED(status)

    def quit(self) -> int:
        """Press Ctrl-Q until the program ends: while the terminal is not raw again, it takes the key for XON."""
        deadline = time.monotonic() + LIMIT
        while self.process.poll() is None and time.monotonic() < deadline:
            os.write(self.master, b"\x11")
            if select.select([self.master], [], [], 0.3)[0]:
                self.drawn += os.read(self.master, 1 << 16)
        return self.end()

    def end(self) -> int:
        """Read to the end and give the exit code."""
        os.close(self.slave)
        with contextlib.suppress(OSError):  # EIO: the other end is closed
            while data := os.read(self.master, 1 << 16):
                self.drawn += data
        return self.process.wait(LIMIT)


class Journal(Recorder):
    """A station that writes the names of its intents to a file at once, without those that change nothing.

    With `crash` its lease breaks the screen.
    """

    def __init__(self, file: Path, *, crash: bool) -> None:
        super().__init__()
        self._file, self._crash = file, crash

    def send(self, *intents: AnyIntent) -> None:
        super().send(*intents)
        with self._file.open("a") as file:
            file.writelines(
                f"{type(intent).__name__}\n" for intent in intents if not isinstance(intent, RenewLease | Watch)
            )
        if self._crash and RenewLease() in intents:
            raise ZeroDivisionError


def main(report: str, *options: str) -> int:
    """Run the screen; what the station got goes to the report."""
    station = Journal(Path(report), crash="--crash" in options)
    if "--stock-mouse" in options:
        ConsoleDriver._enable_mouse_support = LinuxDriver._enable_mouse_support  # type: ignore[method-assign]
    station.offer(snapshot())
    print("a library prints this")
    return run(station, keymap=STANDARD, folder=Path())


if __name__ == "__main__":
    raise SystemExit(main(*sys.argv[1:]))
