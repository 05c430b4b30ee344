"""UDP transport. Never blocks: a datagram that the socket does not accept now is dropped."""

from __future__ import annotations

import asyncio
import socket
from collections.abc import Hashable

from link.endpoint import Endpoint
from link.transport.address import bind_error, resolve
from link.transport.device import DeviceWatch, bind_to_device, watch_device
from link.transport.receive_buffer import ReceiveBuffer
from link.transport.transport import DisconnectCallback, LinkError, Outlet, ReceiveCallback

BATCH = 64
"""Datagrams read in one turn of the event loop: a flood must not starve the control loop (about 1 ms)."""
BUFFER = 65536
"""Bytes of the largest datagram."""
RECEIVE_BUFFER = 1 << 20
"""Bytes that the kernel keeps for a busy program: in a flood its default of 208 kB dropped up to 96 % of all datagrams,
stop commands among them. Linux grants at most net.core.rmem_max."""


class UdpTransport:
    """A UDP socket: `udpin` listens on an address, `udpout` sends to one first and receives only from it.

    The destination's host name is looked up once at the start: UDP has no disconnect after which to look it up again.
    """

    def __init__(self, endpoint: Endpoint, sock: socket.socket) -> None:
        self.endpoint = endpoint
        self.problem: str | None = None
        self.stream = False
        self.fixed_address: Hashable | None = endpoint.text if endpoint.scheme == "udpout" else None
        self.capacity: float | None = None
        self.dropped = 0
        self._socket = sock
        self._buffer = ReceiveBuffer(BUFFER)
        self._loop: asyncio.AbstractEventLoop | None = None
        self._watch: DeviceWatch | None = None

    def start(
        self, loop: asyncio.AbstractEventLoop, on_receive: ReceiveCallback, on_disconnect: DisconnectCallback
    ) -> None:
        """Pass arriving datagrams to `on_receive` in batches. UDP never calls `on_disconnect`."""
        self._loop = loop
        loop.add_reader(self._socket, self._readable, on_receive)
        self._watch = watch_device(self.endpoint, loop, lambda: self._renew(loop, on_receive))

    def send(self, data: bytes, address: Hashable) -> None:
        """Send one datagram, or drop it."""
        try:
            if self.fixed_address is not None:
                self._socket.send(data)
            else:
                self._socket.sendto(data, address)  # type: ignore[call-overload]
        except (BlockingIOError, ConnectionRefusedError):
            self.dropped += 1  # the buffer is full, or no program listens yet: as if the network had lost it
        except OSError as error:
            self.problem = f"{self.endpoint.text}: {error.strerror}"
        else:
            self.problem = None

    def outlet(self, address: Hashable) -> Outlet | None:
        """Return the socket, with the destination unless it is fixed."""
        destination = None if self.fixed_address is not None else address
        return Outlet(self._socket.fileno(), destination, self._socket)

    def close(self) -> None:
        """Stop listening and free the port."""
        if self._watch:
            self._watch.close()
        if self._loop:
            self._loop.remove_reader(self._socket)
        self._socket.close()

    def _renew(self, loop: asyncio.AbstractEventLoop, on_receive: ReceiveCallback) -> bool:
        """Open the socket again; False if that failed."""
        loop.remove_reader(self._socket)
        self._socket.close()
        try:
            self._socket = _open_socket(self.endpoint)
        except LinkError as error:
            self.problem = str(error)
            return False
        self.problem = None
        loop.add_reader(self._socket, self._readable, on_receive)
        return True

    def _readable(self, on_receive: ReceiveCallback) -> None:
        batch: list[tuple[bytes, Hashable]] = []
        for _ in range(BATCH):
            try:
                data, address = self._buffer.recvfrom(self._socket)
            except BlockingIOError:
                break
            except ConnectionRefusedError:
                self.dropped += 1  # nobody has listened when the last datagram came there
                break
            except OSError as error:
                self.problem = f"{self.endpoint.text}: {error.strerror}"
                break
            batch.append((data, self.fixed_address or address))
        if batch:
            on_receive(batch)


def open_udp(endpoint: Endpoint) -> UdpTransport:
    """Open the socket. Raises LinkError."""
    return UdpTransport(endpoint, _open_socket(endpoint))


def _open_socket(endpoint: Endpoint) -> socket.socket:
    address, family = resolve(endpoint, socket.SOCK_DGRAM)
    sock = socket.socket(family, socket.SOCK_DGRAM)
    sock.setblocking(False)
    bind_to_device(sock, endpoint)
    sock.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, RECEIVE_BUFFER)
    try:
        if endpoint.scheme == "udpout":
            sock.connect(address)
        else:
            sock.bind(address)
    except OSError as error:
        sock.close()
        raise bind_error(endpoint, error) from error
    return sock
