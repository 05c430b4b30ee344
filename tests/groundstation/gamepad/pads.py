"""The test's hand on the virtual gamepads of a reader process."""

from __future__ import annotations

import os
import signal
import socket
from pathlib import Path
from types import TracebackType

from link.runtime.local_socket import open_socket
from tests.waits import PATIENCE

SOCKET = "TEST_PAD_SOCKET"
"""Environment variable with the path of the test's socket."""
FULL = 32767


class Hand:
    """Operates the gamepads. The reader that starts within `with` connects."""

    def __init__(self, folder: Path) -> None:
        self._path = folder / "pads.socket"
        self._listener = open_socket()
        self._listener.settimeout(PATIENCE)
        self._listener.bind(str(self._path))
        self._listener.listen()
        self._lines: socket.socket | None = None
        self.reader = 0
        """Process id of the reader."""

    def __enter__(self) -> Hand:
        os.environ[SOCKET] = str(self._path)
        return self

    def __exit__(self, *_: type[BaseException] | BaseException | TracebackType | None) -> None:
        del os.environ[SOCKET]
        self._listener.close()
        if self._lines is not None:
            self._lines.close()

    def meet(self) -> None:
        """Wait for the reader."""
        self._lines, _ = self._listener.accept()
        self._lines.settimeout(PATIENCE)
        self.reader = int(self._lines.recv(64))

    def do(self, *lines: str) -> None:
        """Carry out lines of VirtualPads, in order."""
        assert self._lines is not None
        for line in lines:
            self._lines.send(line.encode())
            assert self._lines.recv(256).decode() == line

    def send_signal(self, number: signal.Signals) -> None:
        """Send a signal to the reader."""
        os.kill(self.reader, number)
