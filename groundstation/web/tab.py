"""One tab: a pseudo-terminal with `mavhelm attach` in it, as a terminal window has, and a socket for its thumb stick.

The screen cannot tell a tab from a terminal: the same keys, timers and pings. The end of the tab closes the terminal,
which means neutral at once.
"""

from __future__ import annotations

import asyncio
import contextlib
import fcntl
import os
import pty
import signal
import socket
import struct
import subprocess
import sys
import termios
from collections.abc import Awaitable, Callable, Mapping, Sequence

import msgspec

from groundstation.input.pad import PadFrame
from groundstation.input.touch_stick import PIPE_VARIABLE
from link.runtime.local_socket import open_pair

READ_SIZE = 1 << 16
"""Bytes of output in one message."""

MAX_UNREAD = 1 << 16
"""Bytes of input that wait for the screen: one message of the largest size, as a pasted text. The kernel takes 4 to
14 kB at once, and a paste whose end is lost would swallow keys."""

END_WITHIN = 3.0
"""s for the screen to leave before it is killed: it is neutral at once, and needs 0.3 s."""

MIN_SIZE, MAX_SIZE = (20, 5), (500, 200)
"""Columns and rows that a tab may ask for."""

_OTHERS = ("TMUX", "TMUX_PANE", "STY", "COLUMNS", "LINES", "TERM_PROGRAM", "NO_COLOR")
"""Variables of the terminal in which the server was started, which is not that of the tab."""


def screen_command(arguments: Sequence[str]) -> list[str]:
    """Return the command that runs `mavhelm` with these arguments in the terminal that is its standard input."""
    return [sys.executable, "-P", "-m", "groundstation.web.controlling_terminal", *arguments]


class Tab:
    """A screen in a pseudo-terminal."""

    def __init__(self, terminal: int, pipe: socket.socket, process: subprocess.Popen[bytes]) -> None:
        """`pipe` takes the frames of the thumb stick."""
        self._terminal = terminal
        self._pipe = pipe
        self._process = process
        self._unread = bytearray()

    @classmethod
    def open(cls, command: Sequence[str], size: tuple[int, int]) -> Tab:
        """Start a program in a terminal of this size. Raises OSError."""
        ours, theirs = pty.openpty()
        pipe, its = open_pair()
        pipe.setblocking(False)
        try:
            _set_size(ours, size)
            os.set_blocking(ours, False)
            process = subprocess.Popen(
                command,
                stdin=theirs,
                stdout=theirs,
                stderr=theirs,
                pass_fds=[its.fileno()],
                start_new_session=True,
                env=_environment(os.environ) | {PIPE_VARIABLE: str(its.fileno())},
            )
        except OSError:
            os.close(ours)
            pipe.close()
            raise
        finally:
            os.close(theirs)
            its.close()
        return cls(ours, pipe, process)

    async def show(self, send: Callable[[bytes], Awaitable[None]]) -> None:
        """Send all that the screen draws, until it ends. A tab that does not read makes it wait, and it notices."""
        while data := await self._read():
            await send(data)

    def type(self, text: str) -> None:
        """Pass on what the browser sends: keys, and answers to pings. Of a screen that does not read it is dropped."""
        data = text.encode("utf-8", "ignore")
        if len(self._unread) + len(data) <= MAX_UNREAD:
            self._unread += data
            self._write()

    def touch(self, frame: PadFrame) -> None:
        """Pass on a frame of the thumb stick. Of a screen that does not read it is dropped: the next one is newer."""
        with contextlib.suppress(OSError):
            self._pipe.send(msgspec.msgpack.encode(frame))

    def resize(self, size: tuple[int, int]) -> None:
        """Change the size in columns and rows."""
        with contextlib.suppress(OSError):
            _set_size(self._terminal, size)

    def hang_up(self) -> None:
        """Tell the screen that its terminal goes, as the end of a terminal does."""
        self._process.send_signal(signal.SIGHUP)

    def kill(self) -> None:
        """End a screen that does not end by itself."""
        self._process.kill()

    async def close(self, within: float = END_WITHIN) -> None:
        """Close the terminal, and wait for the end of the screen; kill it after `within` s."""
        asyncio.get_running_loop().remove_writer(self._terminal)
        os.close(self._terminal)
        self._pipe.close()
        try:
            async with asyncio.timeout(within):
                await asyncio.to_thread(self._process.wait)
        except TimeoutError:
            self.kill()

    def _write(self) -> None:
        """Write what the terminal takes now, and the rest when it takes more."""
        loop = asyncio.get_running_loop()
        loop.remove_writer(self._terminal)
        try:
            del self._unread[: os.write(self._terminal, self._unread)]
        except BlockingIOError:
            pass
        except OSError:  # EIO: the screen has ended
            return
        if self._unread:
            loop.add_writer(self._terminal, self._write)

    async def _read(self) -> bytes:
        """Return the next output, b"" at the end."""
        loop = asyncio.get_running_loop()
        readable = asyncio.Event()
        loop.add_reader(self._terminal, readable.set)
        try:
            await readable.wait()
            return os.read(self._terminal, READ_SIZE)
        except OSError:  # EIO: the screen has ended
            return b""
        finally:
            loop.remove_reader(self._terminal)


def _set_size(terminal: int, size: tuple[int, int]) -> None:
    columns, rows = (max(low, min(high, each)) for each, low, high in zip(size, MIN_SIZE, MAX_SIZE, strict=True))
    fcntl.ioctl(terminal, termios.TIOCSWINSZ, struct.pack("HHHH", rows, columns, 0, 0))


def _environment(ours: Mapping[str, str]) -> dict[str, str]:
    kept = {name: value for name, value in ours.items() if name not in _OTHERS}
    return kept | {"TERM": "xterm-256color", "COLORTERM": "truecolor"}
