"""Serial port transport: pyserial opens and configures the port, the event loop reads and writes it.

Never blocks. A port that is missing or was unplugged is reopened as soon as it is there.
"""

from __future__ import annotations

import asyncio
import contextlib
import fcntl
import os
import stat
import struct
import termios
from collections.abc import Hashable

import serial

from link.endpoint import Endpoint
from link.transport.backoff import Backoff
from link.transport.priority_queue import TransmitPacer, TransmitQueue
from link.transport.serial_faults import ABSENT_ERRNOS, serial_error_text
from link.transport.stream_writer import StreamWriter
from link.transport.transport import DisconnectCallback, LinkError, Outlet, ReceiveCallback

BITS_PER_BYTE = 10
"""8 data bits, one start and one stop bit."""
BULK_WAIT = 0.25
"""s of transmission time that telemetry may wait: longer than any burst of ours; older telemetry is not worth
sending."""
BULK_LEAST = 600
"""Lower limit in bytes, for slow ports: two of the longest frames."""
READ = 4096


class SerialTransport:
    """One serial port, by its path. `port` is open, or None while it is missing."""

    def __init__(self, endpoint: Endpoint, port: serial.Serial | None) -> None:
        self.endpoint = endpoint
        self.problem = None if port else _missing_text(endpoint)
        self.stream = True
        self.fixed_address: Hashable | None = endpoint.text
        self.capacity: float | None = endpoint.baud / BITS_PER_BYTE
        self._queue = TransmitQueue(max(BULK_LEAST, int(endpoint.baud / BITS_PER_BYTE * BULK_WAIT)))
        self._port = port
        self._writer: StreamWriter | None = None
        self._backoff = Backoff()
        self._timer: asyncio.TimerHandle | None = None
        self._closed = False
        self._loop: asyncio.AbstractEventLoop | None = None
        self._on_receive: ReceiveCallback = lambda _: None
        self._on_disconnect: DisconnectCallback = lambda _: None

    @property
    def dropped(self) -> int:
        """Frames dropped because the port had no room."""
        return self._queue.dropped

    def start(
        self, loop: asyncio.AbstractEventLoop, on_receive: ReceiveCallback, on_disconnect: DisconnectCallback
    ) -> None:
        """Start to receive, or to wait for a missing port."""
        self._loop, self._on_receive, self._on_disconnect = loop, on_receive, on_disconnect
        if self._port:
            self._use(loop, self._port)
        else:
            self._try_later(loop)

    def send(self, data: bytes, address: Hashable) -> None:
        """Queue one frame; while the port is missing it is dropped, because it would be old later."""
        if self._writer:
            self._writer.send(data)

    def outlet(self, address: Hashable) -> Outlet | None:
        """Return the port, while it is open."""
        return Outlet(self._port.fileno(), None, self._port) if self._port else None

    def close(self) -> None:
        """Pass the last frames to the driver and free the port."""
        self._closed = True
        if self._timer:
            self._timer.cancel()
        if self._writer:
            self._writer.flush_and_close()
        self._release()

    def _use(self, loop: asyncio.AbstractEventLoop, port: serial.Serial) -> None:
        self._port, self.problem = port, None
        descriptor = port.fileno()
        self._writer = StreamWriter(
            descriptor,
            self._queue,
            lambda data: os.write(descriptor, data),
            lambda error: self._handle_loss(error.strerror or str(error)),
            pacer=TransmitPacer(self.endpoint.baud / BITS_PER_BYTE),
            in_driver=lambda: _in_driver(descriptor),
        )
        loop.add_reader(descriptor, self._readable, descriptor)

    def _readable(self, descriptor: int) -> None:
        try:
            data = os.read(descriptor, READ)
        except BlockingIOError:
            return
        except OSError as error:
            self._handle_loss(error.strerror or str(error))
            return
        if not data:
            self._handle_loss("hung up")
            return
        self._backoff.reset()
        self._on_receive([(data, self.endpoint.text)])

    def _handle_loss(self, why: str) -> None:
        """Release a port that was unplugged or failed, and drop what waits to be sent."""
        if self._closed or self._port is None or self._loop is None:
            return
        self.problem = f"{self.endpoint.text}: lost the port ({why}); waiting for it"
        if self._writer:
            self._writer.close()
        with contextlib.suppress(termios.error, OSError):
            termios.tcflush(self._port.fileno(), termios.TCIOFLUSH)  # or close() may wait 30 s for bytes to leave
        self._release()
        self._on_disconnect(self.endpoint.text)
        self._try_later(self._loop)

    def _release(self) -> None:
        port, self._port, self._writer = self._port, None, None
        if port is None:
            return
        if self._loop:
            self._loop.remove_reader(port.fileno())
        with contextlib.suppress(OSError):
            port.close()

    def _try_later(self, loop: asyncio.AbstractEventLoop) -> None:
        self._timer = loop.call_later(self._backoff.next_delay(), self._try, loop)

    def _try(self, loop: asyncio.AbstractEventLoop) -> None:
        try:
            port = _open(self.endpoint)
        except LinkError as error:
            self.problem = f"{error}; trying again"
        else:
            if port:
                self._use(loop, port)
                return
            self.problem = _missing_text(self.endpoint)
        self._try_later(loop)


def open_serial(endpoint: Endpoint) -> SerialTransport:
    """Open the port, or wait for a missing one. Raises LinkError for what waiting cannot repair."""
    return SerialTransport(endpoint, _open(endpoint))


def _missing_text(endpoint: Endpoint) -> str:
    return f"{endpoint.text}: waiting for {endpoint.path}, it is not there; is it plugged in?"


def _open(endpoint: Endpoint) -> serial.Serial | None:
    """Return the configured port, or None if there is none. Raises LinkError."""
    try:
        if not stat.S_ISCHR(os.stat(endpoint.path).st_mode):
            raise LinkError(f"{endpoint.text}: {endpoint.path} is not a serial port but a file or directory")
        port = serial.Serial(endpoint.path, endpoint.baud, timeout=0, exclusive=True)
        try:
            _configure(port)
        except BaseException:
            port.close()
            raise
    except (OSError, termios.error) as error:  # SerialException is an OSError; termios.error is not
        fault = OSError(*error.args)
        if fault.errno in ABSENT_ERRNOS:
            return None
        raise LinkError(f"{endpoint.text}: {serial_error_text(endpoint.path, fault)}") from error
    except (ValueError, OverflowError) as error:
        raise LinkError(f"{endpoint.text}: the port does not take {endpoint.baud} baud; try 57600") from error
    return port


def _configure(port: serial.Serial) -> None:
    """Apply the settings that pyserial does not offer."""
    descriptor = port.fileno()
    os.set_blocking(descriptor, False)
    settings = termios.tcgetattr(descriptor)
    settings[2] &= ~termios.HUPCL  # keep DTR as it is on close: many boards reset when it falls
    settings[6][termios.VMIN] = 1  # or "nothing to read" would look like "unplugged"
    termios.tcsetattr(descriptor, termios.TCSANOW, settings)
    with contextlib.suppress(ValueError, OSError, AttributeError, NotImplementedError):  # the last one on macOS
        port.set_low_latency_mode(True)  # FTDI: 1 ms instead of 16; other drivers raise


def _in_driver(descriptor: int) -> int:
    """Return the bytes that the driver has not sent yet, or 0 if it does not know."""
    try:
        (waiting,) = struct.unpack("i", fcntl.ioctl(descriptor, termios.TIOCOUTQ, b"\0\0\0\0"))
    except OSError:
        return 0
    return int(waiting)
