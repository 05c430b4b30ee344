"""A serial port to a motor controller that never makes the control loop wait; frames go out whole or not at all."""

from __future__ import annotations

import contextlib
import os
import select
import termios
from typing import Any

import serial

from link.transport.serial_faults import serial_error_text

SEND_QUEUE_MAX = 64
"""Bytes that may wait in the kernel: about eight frames. More are old demands, and the newest must not stand behind."""


class SerialPort:
    """Opened by path, and again by path after it was lost: a USB adapter may be unplugged. All raise OSError."""

    def __init__(self, path: str, baud: int) -> None:
        self.path = path
        self._baud = baud
        self._serial: Any = None

    @property
    def is_open(self) -> bool:
        """It was opened, and no fault has closed it since."""
        return self._serial is not None

    def open(self) -> bool:
        """True where it was closed before."""
        if self._serial is not None:
            return False
        # exclusive: two writers would mix their frames. No flow control, and no time in which pyserial may wait.
        try:
            self._serial = serial.Serial(self.path, self._baud, timeout=0, write_timeout=0, exclusive=True)
        except (OSError, termios.error) as error:  # termios's own are no OSErrors: it went while it was set up
            raise OSError(serial_error_text(self.path, OSError(*error.args))) from error
        self.discard_input()
        return True

    def write(self, frame: bytes) -> None:
        """Not pyserial's own write: in its non-blocking mode it spins for ever on a full buffer (3.5)."""
        with self._closing():
            if self._serial.out_waiting > SEND_QUEUE_MAX:
                raise BlockingIOError(f"{self.path}: the port does not take what is sent")
            written = os.write(self._serial.fileno(), frame)
            if written != len(frame):
                termios.tcflush(self._serial.fileno(), termios.TCOFLUSH)
                raise BlockingIOError(f"{self.path}: the port took half a frame")

    def read(self, wait: float = 0.0) -> bytes:
        """What has come, at most 256 bytes; after `wait` s at the latest."""
        with self._closing():
            if not select.select([self._serial.fileno()], [], [], wait)[0]:
                return b""
            data = os.read(self._serial.fileno(), 256)
            if not data:
                raise OSError(f"{self.path}: the port is gone")
            return data

    def discard_input(self) -> None:
        """Forget what has come."""
        with self._closing():
            self._serial.reset_input_buffer()

    def discard_output(self) -> None:
        """Forget what waits to be sent."""
        with self._closing():
            self._serial.reset_output_buffer()

    def close(self) -> None:
        """Let go of it; may come twice."""
        port, self._serial = self._serial, None
        if port is not None:
            with contextlib.suppress(OSError):  # a port that is gone cannot even be closed properly
                port.close()

    @contextlib.contextmanager
    def _closing(self) -> Any:
        """A port that fails is closed, so that `open` may try it anew; a full one is not."""
        if self._serial is None:
            raise OSError(f"{self.path}: not open")
        try:
            yield
        except BlockingIOError:
            raise
        except (OSError, termios.error) as error:
            self.close()
            raise OSError(f"{self.path}: {error}") from error
