"""A serial cable between two real programs: two ptys, connected at a baud rate, that can be unplugged."""

from __future__ import annotations

import os
import pty
import select
import threading
import time
import tty
from pathlib import Path

STEP = 0.001
"""s between two polls; 5 bytes pass in that time at 57600 baud."""


class _End:
    """One end: the program opens `path`, the test holds `far`."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self.far, self._near = pty.openpty()
        tty.setraw(self._near)
        os.set_blocking(self.far, False)
        path.unlink(missing_ok=True)
        path.symlink_to(os.ttyname(self._near))

    def read(self, most: int) -> bytes:
        try:
            return os.read(self.far, most)
        except BlockingIOError:
            return b""

    def write(self, data: bytes) -> None:
        try:
            os.write(self.far, data)
        except BlockingIOError:
            return  # no program reads there: a UART would have lost it, too

    def close(self) -> None:
        self.path.unlink(missing_ok=True)
        os.close(self._near)
        os.close(self.far)


class SerialCable:
    """`one` and `two` are the endpoints for the programs."""

    def __init__(self, folder: Path, baud: int = 57600) -> None:
        self.one = f"serial:{folder}/tty-one:{baud}"
        self.two = f"serial:{folder}/tty-two:{baud}"
        self._folder = folder
        self._per_second = baud / 10
        self._lock = threading.Lock()
        self._ends: tuple[_End, ...] = ()
        self._running = True
        self.plug()
        self._thread = threading.Thread(target=self._run, name="cable", daemon=True)
        self._thread.start()

    def plug(self) -> None:
        """Create new devices under the old names, as USB adapters do."""
        with self._lock:
            self._ends = tuple(_End(self._folder / name) for name in ("tty-one", "tty-two"))

    def unplug(self) -> None:
        """Remove both devices."""
        with self._lock:
            for end in self._ends:
                end.close()
            self._ends = ()

    def close(self) -> None:
        """Close the cable."""
        self._running = False
        self._thread.join(5)
        self.unplug()

    def _run(self) -> None:
        passed = time.monotonic()
        while self._running:
            select.select([], [], [], STEP)
            room = int((time.monotonic() - passed) * self._per_second)
            passed += room / self._per_second
            with self._lock:
                if self._ends and room:
                    one, two = self._ends
                    two.write(one.read(room))
                    one.write(two.read(room))
