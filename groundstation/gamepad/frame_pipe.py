"""Reads the frames of a gamepad, or of a tab's thumb stick, in a thread of its own, so that drawing delays none."""

from __future__ import annotations

import contextlib
import socket
import threading
import time
from collections.abc import Callable

import msgspec

from groundstation.input.pad import PadFrame

MAX_FRAME = 4096

TakeFrame = Callable[[PadFrame], None]


class FramePipe:
    """One end of a socket of packets, on which another process sends frames."""

    def __init__(self) -> None:
        self.frame = PadFrame(time.monotonic())
        """The newest one; without names when there is no gamepad."""
        self.ended = False
        """The other end is closed."""
        self._pipe: socket.socket | None = None

    def start(self, pipe: socket.socket, take: TakeFrame) -> None:
        """Read; `take` is called with each frame in another thread, with an empty one at the end."""
        self._pipe = pipe
        threading.Thread(target=self._run, args=(pipe, take), name="gamepad", daemon=True).start()

    def send(self, packet: bytes) -> None:
        """Send a request to the other end, if it is there."""
        with contextlib.suppress(OSError):
            if self._pipe is not None:
                self._pipe.send(packet)

    def stop(self) -> None:
        """Close both directions: the thread ends, and the other process sees it."""
        with contextlib.suppress(OSError):
            if self._pipe is not None:
                self._pipe.shutdown(socket.SHUT_RDWR)

    def _run(self, pipe: socket.socket, take: TakeFrame) -> None:
        with pipe:
            while packet := _receive(pipe):
                with contextlib.suppress(msgspec.DecodeError):
                    self.frame = msgspec.msgpack.decode(packet, type=PadFrame)
                    take(self.frame)
        self.frame, self.ended = PadFrame(time.monotonic()), True
        take(self.frame)


def _receive(pipe: socket.socket) -> bytes:
    try:
        return pipe.recv(MAX_FRAME)
    except OSError:
        return b""
