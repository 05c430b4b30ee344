"""Serial cables for tests: a pty behind a path that can be unplugged, and a cable that passes bytes at a baud rate."""

from __future__ import annotations

import asyncio
import fcntl
import os
import pty
import termios
import tty
from collections.abc import Hashable, Sequence
from pathlib import Path

from link.transport.transport import Transport


class Cable:
    """A pty. The program under test opens `path`; the test holds the other end."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self.plug()

    @property
    def endpoint(self) -> str:
        return f"serial:{self.path}:57600"

    def plug(self) -> None:
        """A new device under the old name, as USB does it."""
        self.far, near = pty.openpty()
        tty.setraw(near)
        os.set_blocking(self.far, False)
        self.path.symlink_to(os.ttyname(near))
        self._near = near

    def unplug(self) -> None:
        self.path.unlink(missing_ok=True)
        os.close(self._near)
        os.close(self.far)

    def read(self, most: int = 65536) -> bytes:
        """What the program has written, as much as is there."""
        try:
            return os.read(self.far, most)
        except BlockingIOError:
            return b""

    def write(self, data: bytes) -> None:
        assert os.write(self.far, data) == len(data)


class BaudCable(Cable):
    """A cable that passes what the program writes at `baud`, as the line of a UART does; the rest waits in the pty."""

    def __init__(self, path: Path, baud: int) -> None:
        super().__init__(path)
        self.received = b""
        self._per_second = baud / 10
        self._loop = asyncio.get_running_loop()
        self._passed_until = self._loop.time()
        self._timer: asyncio.Handle
        self._timer = self._loop.call_soon(self._pass)

    @property
    def waiting(self) -> int:
        """Bytes that the program has written and the line has not passed yet."""
        return int.from_bytes(fcntl.ioctl(self.far, termios.FIONREAD, bytes(4)), "little")

    def _pass(self) -> None:
        self.pass_on()
        self._timer = self._loop.call_later(0.001, self._pass)

    def pass_on(self) -> None:
        """What the line has passed by now."""
        now = self._loop.time()
        room = int((now - self._passed_until) * self._per_second)
        if room:
            self._passed_until += room / self._per_second
            self.received += self.read(room)

    def unplug(self) -> None:
        self._timer.cancel()
        super().unplug()


class Heard:
    """What a transport has handed over."""

    def __init__(self, transport: Transport) -> None:
        self.transport = transport
        self.data: list[tuple[bytes, Hashable]] = []
        self.gone: list[Hashable] = []
        transport.start(asyncio.get_running_loop(), self._arrived, self.gone.append)

    def _arrived(self, pieces: Sequence[tuple[bytes, Hashable]]) -> None:
        self.data += pieces

    @property
    def bytes(self) -> bytes:
        return b"".join(data for data, _ in self.data)
