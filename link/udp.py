"""UDP: datagrams in, datagrams out. Never blocks; what the network will not take now is dropped, the newest wins."""

from __future__ import annotations

import asyncio
import errno
import socket
from collections.abc import Hashable

from link.channel import Channel
from link.endpoint import Endpoint
from link.link import Datagrams, LinkError

BATCH = 64
"""Datagrams read before the loop gets its turn again: a flood must not starve the control loop (about 1 ms)."""
BUFFER = 65536


class UdpLink:
    """One UDP socket: `udpin` waits on an address, `udpout` speaks to one first and hears only that one."""

    def __init__(self, endpoint: Endpoint, channel: Channel, sock: socket.socket) -> None:
        self.endpoint = endpoint
        self.channel = channel
        self.problem: str | None = None
        self._socket = sock
        self._connected = endpoint.scheme == "udpout"
        self._buffer = memoryview(bytearray(BUFFER))
        self._loop: asyncio.AbstractEventLoop | None = None

    def start(self, loop: asyncio.AbstractEventLoop, deliver: Datagrams) -> None:
        """Hand arriving datagrams to `deliver` in batches."""
        self._loop = loop
        loop.add_reader(self._socket, self._readable, deliver)

    def send(self, data: bytes, address: Hashable) -> None:
        """One datagram, now or never."""
        try:
            if self._connected:
                self._socket.send(data)
            else:
                self._socket.sendto(data, address)  # type: ignore[call-overload]
        except (BlockingIOError, ConnectionRefusedError):
            return  # full, or nobody listens yet: as if the network had lost it
        except OSError as error:
            self.problem = f"{self.endpoint.text}: {error.strerror}"
        else:
            self.problem = None

    def close(self) -> None:
        """Stop listening and free the port."""
        if self._loop:
            self._loop.remove_reader(self._socket)
        self._socket.close()

    def _readable(self, deliver: Datagrams) -> None:
        batch: list[tuple[bytes, Hashable]] = []
        for _ in range(BATCH):
            try:
                size, address = self._socket.recvfrom_into(self._buffer)
            except (BlockingIOError, ConnectionRefusedError):
                break
            except OSError as error:
                self.problem = f"{self.endpoint.text}: {error.strerror}"
                break
            batch.append((bytes(self._buffer[:size]), self.channel.name if self._connected else address))
        if batch:
            deliver(self, batch)


def open_udp(endpoint: Endpoint, index: int, *, system: int, component: int, wanted: frozenset[int] | None) -> UdpLink:
    """Open the socket. Raises LinkError with one line that says what is wrong and what to do."""
    address, family = _resolve(endpoint)
    sock = socket.socket(family, socket.SOCK_DGRAM)
    sock.setblocking(False)
    try:
        if endpoint.scheme == "udpout":
            sock.connect(address)
        else:
            sock.bind(address)
    except OSError as error:
        sock.close()
        raise LinkError(_reason(endpoint, error)) from error
    target = endpoint.text if endpoint.scheme == "udpout" else None
    channel = Channel(endpoint.text, index, system=system, component=component, wanted=wanted, target=target)
    return UdpLink(endpoint, channel, sock)


def _resolve(endpoint: Endpoint) -> tuple[tuple[str, int], socket.AddressFamily]:
    try:
        found = socket.getaddrinfo(endpoint.host, endpoint.port, type=socket.SOCK_DGRAM)
    except (OSError, UnicodeError) as error:
        raise LinkError(
            f"{endpoint.text}: host {endpoint.host!r} is not known; check its name or use its number"
        ) from error
    family, _, _, _, address = found[0]
    return (str(address[0]), int(address[1])), family


def _reason(endpoint: Endpoint, error: OSError) -> str:
    if error.errno == errno.EADDRINUSE:
        return (
            f"{endpoint.text}: port {endpoint.port} is in use; stop the other program (`ss -lunp`) or take another port"
        )
    if error.errno == errno.EADDRNOTAVAIL:
        return f"{endpoint.text}: {endpoint.host} is no address of this machine; use one of its own, or 0.0.0.0 for all"
    if error.errno in (errno.EACCES, errno.EPERM):
        return f"{endpoint.text}: not allowed; ports below 1024 belong to root, take a higher one"
    return f"{endpoint.text}: {error.strerror}"
