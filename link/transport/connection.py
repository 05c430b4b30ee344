"""One open TCP connection: never blocks, and detects a dead peer by keepalive."""

from __future__ import annotations

import asyncio
import socket
from collections.abc import Callable, Hashable

from link.transport.priority_queue import TransmitQueue
from link.transport.receive_buffer import ReceiveBuffer
from link.transport.stream_writer import StreamWriter
from link.transport.transport import Outlet, ReceiveCallback

BULK = 65536
"""Bytes of telemetry that may wait for one connection; then the oldest is dropped."""
SEND_BUFFER = 32768
"""Bytes that the kernel buffers, where nothing can overtake; its own default grows to megabytes."""
READ = 65536
"""Bytes that one turn of the event loop reads at most."""
DEAD_AFTER = 10
"""s without an acknowledgement after which the other end counts as gone; twice the vehicle's GCS timeout."""


class Connection:
    """One open connection. `on_end` gets the reason when it ends, but not after close()."""

    def __init__(
        self,
        sock: socket.socket,
        address: Hashable,
        on_receive: ReceiveCallback,
        on_end: Callable[[Connection, str], None],
    ) -> None:
        _prepare(sock)
        self.address = address
        self.queue = TransmitQueue(BULK)
        self._socket = sock
        self._buffer = ReceiveBuffer(READ)
        self._on_receive = on_receive
        self._on_end = on_end
        self._writer = StreamWriter(sock.fileno(), self.queue, sock.send, self._failed)
        self._loop = asyncio.get_running_loop()
        self.last_received = self._loop.time()
        """When the last bytes came, or else when the connection was opened; time of the event loop."""
        self._loop.add_reader(sock, self._readable)

    def send(self, data: bytes) -> None:
        """Send one frame, now or soon."""
        self._writer.send(data)

    @property
    def outlet(self) -> Outlet:
        """The connected socket."""
        return Outlet(self._socket.fileno(), None, self._socket)

    def close(self) -> None:
        """Send what the socket accepts at once, and end the connection."""
        self._on_end = lambda *_: None
        self._writer.flush_and_close()
        self._release()

    def _readable(self) -> None:
        try:
            data = self._buffer.recv(self._socket)
        except BlockingIOError:
            return
        except OSError as error:
            self._failed(error)
            return
        if data:
            self.last_received = self._loop.time()
            self._on_receive([(data, self.address)])
        else:
            self._end("closed by the other end")

    def _failed(self, error: OSError) -> None:
        self._end(error.strerror or str(error))

    def _end(self, why: str) -> None:
        self._writer.close()
        self._release()
        self._on_end(self, why)

    def _release(self) -> None:
        if self._socket.fileno() >= 0:
            self._loop.remove_reader(self._socket)
            self._socket.close()


def _prepare(sock: socket.socket) -> None:
    sock.setblocking(False)
    sock.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
    sock.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, SEND_BUFFER)
    sock.setsockopt(socket.SOL_SOCKET, socket.SO_KEEPALIVE, 1)
    sock.setsockopt(socket.IPPROTO_TCP, socket.TCP_KEEPIDLE, DEAD_AFTER // 2)
    sock.setsockopt(socket.IPPROTO_TCP, socket.TCP_KEEPINTVL, 1)
    sock.setsockopt(socket.IPPROTO_TCP, socket.TCP_KEEPCNT, DEAD_AFTER // 2)
    sock.setsockopt(socket.IPPROTO_TCP, socket.TCP_USER_TIMEOUT, DEAD_AFTER * 1000)
