"""A serial port to a motor controller that never blocks the control loop; a frame is sent completely or not at all."""

from __future__ import annotations

import contextlib
import os
import select
import termios
from typing import Any

import serial

from link.transport.serial_faults import serial_error_text

SEND_QUEUE_MAX = 64
"""Bytes that may wait in the kernel: about eight frames. More would delay the newest demand behind old ones."""


class MotorPort:
    """A port that is opened again by its path after it was lost, as with a USB adapter. All methods raise OSError."""

    def __init__(self, path: str, baud: int) -> None:
        self.path = path
        self._baud = baud
        self._serial: Any = None

    @property
    def is_open(self) -> bool:
        """Whether the port was opened and no error has closed it since."""
        return self._serial is not None

    def open(self) -> bool:
        """Open the port if it is closed. Returns True if it was."""
        if self._serial is not None:
            return False
        # exclusive: two writers would mix their frames. No flow control, and zero timeouts: pyserial never blocks.
        try:
            self._serial = serial.Serial(self.path, self._baud, timeout=0, write_timeout=0, exclusive=True)
        except (OSError, termios.error) as error:  # termios.error is not an OSError: the port vanished during setup
            raise OSError(serial_error_text(self.path, OSError(*error.args))) from error
        self.discard_input()
        return True

    def write(self, frame: bytes) -> None:
        """Send a frame. Not pyserial's write, which loops forever on a full buffer in non-blocking mode (3.5)."""
        with self._closing():
            if self._serial.out_waiting > SEND_QUEUE_MAX:
                raise BlockingIOError(f"{self.path}: the port does not send (its buffer is full)")
            written = os.write(self._serial.fileno(), frame)
            if written != len(frame):
                termios.tcflush(self._serial.fileno(), termios.TCOFLUSH)
                raise BlockingIOError(f"{self.path}: the port accepted only part of a frame")

    def read(self, wait: float = 0.0) -> bytes:
        """Return received bytes, at most 256; empty after `wait` s without any."""
        with self._closing():
            if not select.select([self._serial.fileno()], [], [], wait)[0]:
                return b""
            data = os.read(self._serial.fileno(), 256)
            if not data:
                raise OSError(f"{self.path}: the port is gone")
            return data

    def discard_input(self) -> None:
        """Discard the received bytes."""
        with self._closing():
            self._serial.reset_input_buffer()

    def discard_output(self) -> None:
        """Discard the bytes that wait to be sent."""
        with self._closing():
            self._serial.reset_output_buffer()

    def close(self) -> None:
        """Close the port; may be called twice."""
        port, self._serial = self._serial, None
        if port is not None:
            with contextlib.suppress(OSError):  # closing a vanished port fails
                port.close()

    @contextlib.contextmanager
    def _closing(self) -> Any:
        """Close the port on an error, so that `open` can open it again; a full buffer is not such an error."""
        if self._serial is None:
            raise OSError(f"{self.path}: not open")
        try:
            yield
        except BlockingIOError:
            raise
        except (OSError, termios.error) as error:
            self.close()
            raise OSError(f"{self.path}: {error}") from error
