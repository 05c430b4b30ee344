"""A controller at the other end of a real terminal line (a pty), running in a thread by the real clock."""

from __future__ import annotations

import contextlib
import os
import pty
import select
import threading
import time
import tty
from collections.abc import Callable
from typing import Any

from tests.vehicle.motors.controllers import Controller
from tests.waits import PATIENCE


class OnPty:
    """`path` is the serial port to open. Use it as a context manager."""

    def __init__(self, controller: Controller) -> None:
        self.controller: Any = controller
        self.tail = b""
        """The last bytes that came."""
        self.history: list[list[float]] = []
        """Each change of the motor outputs, also those that were over before anybody looked."""
        self._master, self._slave = pty.openpty()  # our own end of the slave keeps the line up between processes
        tty.setraw(self._slave)
        os.set_blocking(self._master, False)
        self.path = os.ttyname(self._slave)
        self._stop, self._stopping = os.pipe()
        self.deaf = threading.Event()
        """Set: nobody reads the line."""
        self._changed = threading.Condition()
        self._thread = threading.Thread(target=self._run, daemon=True)

    def __enter__(self) -> OnPty:
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        os.write(self._stopping, b"x")
        self._thread.join()
        for descriptor in (self._master, self._slave, self._stop, self._stopping):
            with contextlib.suppress(OSError):
                os.close(descriptor)

    def until(self, holds: Callable[[], bool], within: float = PATIENCE) -> float:
        """s until `holds`; fails the test after `within`."""
        began = time.monotonic()
        with self._changed:
            assert self._changed.wait_for(holds, within), "it never came to pass"
        return time.monotonic() - began

    def outputs_after(self, written: list[bytes]) -> list[float]:
        """What the motors get once the last frame of `written` has come through the line."""
        if written:
            self.until(lambda: self.tail.endswith(written[-1]))
        with self._changed:
            self.controller.tick(time.monotonic())
            return list(self.controller.outputs)

    def _run(self) -> None:
        while True:
            listening = [self._stop] if self.deaf.is_set() else [self._stop, self._master]
            ready, _, _ = select.select(listening, [], [], 0.005)
            if self._stop in ready:
                return
            with self._changed:
                self._take(hears=self._master in listening)
                self._changed.notify_all()

    def _take(self, *, hears: bool) -> None:
        """Read what has come by now, also while this thread was late, and only then look at the timeout."""
        now, data = time.monotonic(), b""
        with contextlib.suppress(BlockingIOError):
            data = os.read(self._master, 4096) if hears else b""
        if data:
            self.tail = (self.tail + data)[-64:]
            reply = self.controller.feed(data, now)
            with contextlib.suppress(BlockingIOError):  # nobody reads the replies
                os.write(self._master, reply)
            self._note()
        self.controller.tick(now)
        self._note()

    def _note(self) -> None:
        if not self.history or self.history[-1] != self.controller.outputs:
            self.history.append(list(self.controller.outputs))


def recorded(port: Any) -> list[bytes]:
    """The frames that `port` writes from now on."""
    frames: list[bytes] = []
    write = port.write

    def write_and_note(frame: bytes) -> None:
        write(frame)
        frames.append(frame)

    port.write = write_and_note
    return frames
