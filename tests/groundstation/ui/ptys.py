"""A real pseudo-terminal with the real app in it: what the other end writes are bytes, as a terminal sends them."""

from __future__ import annotations

import asyncio
import contextlib
import fcntl
import os
import pty
import signal
import struct
import subprocess
import termios
from collections.abc import AsyncIterator, Iterable
from pathlib import Path
from threading import Thread
from typing import TypeVar

from groundstation.input.keymap import KEYMAPS, Keymap
from groundstation.ui.app.app import ConsoleApp
from groundstation.ui.look.appearance import PLAIN, Look
from groundstation.ui.terminal.tty_output import TerminalFile
from tests.groundstation.ui.examples import Recorder
from tests.waits import PATIENCE, until

STANDARD = Keymap("standard", KEYMAPS["standard"])
PRESS_W, REPEAT_W, RELEASE_W = "\x1b[119;1:1;119u", "\x1b[119;1:2;119u", "\x1b[119;1:3u"
"""The key W as a terminal with the kitty keyboard protocol sends it."""


Value = TypeVar("Value")


def attach_pty(
    command: list[str], folder: Path, size: tuple[int, int] = (100, 30), **environment: str
) -> tuple[subprocess.Popen[bytes], int]:
    """Start a program on a pseudo-terminal of its own session; return it and the person's end."""
    master, slave = pty.openpty()
    fcntl.ioctl(slave, termios.TIOCSWINSZ, struct.pack("HHHH", size[1], size[0], 0, 0))
    environment = {**os.environ, "TERM": "xterm-256color", **environment}
    process = subprocess.Popen(
        command, cwd=folder, env=environment, start_new_session=True, stdin=slave, stdout=slave, stderr=slave
    )
    os.close(slave)
    return process, master


class Terminal:
    """The person's end of the pseudo-terminal: reads what is drawn, answers pings while told to."""

    def __init__(self, master: int, slave: int, *, answers: bool = True) -> None:
        self.drawn = bytearray()
        self.answers = answers
        self._master, self._slave = master, slave
        self._hung_up = False
        self._loop = asyncio.get_running_loop()
        # In a thread: the app's end waits for what it wrote to be read, and it ends in the test's own loop.
        self._reader = Thread(target=self._read, daemon=True)
        self._reader.start()

    def type(self, data: str | bytes) -> None:
        """Send bytes as one write."""
        os.write(self._master, data.encode() if isinstance(data, str) else data)

    async def type_each(self, keys: Iterable[str], gap: float) -> None:
        """Send keys, each at its own absolute time, `gap` s apart."""
        start = self._loop.time()
        done = self._loop.create_future()
        keys = list(keys)
        for number, key in enumerate(keys):
            self._loop.call_at(start + number * gap, self.type, key)
        self._loop.call_at(start + len(keys) * gap, done.set_result, None)
        await done

    def hang_up(self) -> None:
        """Close this end. (The reader would keep it open, so it is woken by a last byte to read.)"""
        if not self._hung_up:
            self._hung_up = True
            os.write(self._slave, b"!")
            self._reader.join()

    def _read(self) -> None:
        with contextlib.suppress(OSError):
            while not self._hung_up:
                data = os.read(self._master, 1 << 16)
                self.drawn += data
                if self.answers:
                    self.type(b"\x1b[0n" * data.count(b"\x1b[5n"))
        os.close(self._master)


@contextlib.asynccontextmanager
async def app_on_a_pty(
    size: tuple[int, int] = (100, 30), *, look: Look = PLAIN, folder: Path = Path(), answers: bool = True
) -> AsyncIterator[tuple[ConsoleApp, Recorder, Terminal]]:
    """The app with the Drive screen up and its gate open; on leaving it is quit if it has not ended by itself."""
    master, slave = pty.openpty()
    fcntl.ioctl(slave, termios.TIOCSWINSZ, struct.pack("HHHH", size[1], size[0], 0, 0))
    handlers = {number: signal.getsignal(number) for number in (signal.SIGTSTP, signal.SIGCONT, signal.SIGWINCH)}
    recorder, terminal = Recorder(), Terminal(master, slave, answers=answers)
    app = ConsoleApp(recorder, STANDARD, terminal=TerminalFile(slave, slave), folder=folder, look=look)
    running = asyncio.create_task(app.run_async(mouse=False))
    try:
        await until(lambda: app.gate.closure is None or running.done())
        yield app, recorder, terminal
    finally:
        if not running.done():
            app.end()
        await asyncio.wait_for(running, PATIENCE)
        recorder.close()
        terminal.hang_up()
        os.close(slave)
        for number, handler in handlers.items():
            signal.signal(number, handler)
