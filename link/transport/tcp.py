"""TCP transports: `tcpin` accepts several connections, `tcpout` keeps one and reconnects."""

from __future__ import annotations

import asyncio
import contextlib
import os
import socket
from collections import Counter
from collections.abc import Callable, Hashable

from link.endpoint import Endpoint
from link.protocol.link_events import CONNECTING
from link.runtime.worker import Worker
from link.transport.address import bind_error, resolve
from link.transport.backoff import Backoff
from link.transport.device import DeviceWatch, bind_to_device, watch_device
from link.transport.priority_queue import TransmitQueue
from link.transport.receive_buffer import ReceiveBuffer
from link.transport.stream_writer import StreamWriter
from link.transport.transport import DisconnectCallback, LinkError, Outlet, ReceiveCallback

MAX_CONNECTIONS = 16
"""Connections to one `tcpin`. A further one replaces the connection that has been silent longest, or one of the host
with the most of them, or is closed."""
HOST_CONNECTIONS = 4
"""Connections that a host keeps when others need them: several ground stations behind one address translation."""
EVICT_AFTER = 10.0
"""s of silence after which a connection may be replaced: a ground station sends a HEARTBEAT each second."""
CONNECT_TIMEOUT = 5.0
"""s before a connection attempt is given up."""


class TcpServerTransport:
    """`tcpin`: each connection is a separate peer."""

    def __init__(self, endpoint: Endpoint, sock: socket.socket) -> None:
        self.endpoint = endpoint
        self.problem: str | None = None
        self.stream = True
        self.fixed_address: Hashable | None = None
        self.capacity: float | None = None
        self._socket = sock
        self._connections: dict[Hashable, Connection] = {}
        self._dropped = 0
        self._loop: asyncio.AbstractEventLoop | None = None
        self._watch: DeviceWatch | None = None
        self._on_receive: ReceiveCallback = lambda _: None
        self._on_disconnect: DisconnectCallback = lambda _: None

    @property
    def dropped(self) -> int:
        """Frames dropped because a connection had no room."""
        return self._dropped + sum(each.queue.dropped for each in self._connections.values())

    def start(
        self, loop: asyncio.AbstractEventLoop, on_receive: ReceiveCallback, on_disconnect: DisconnectCallback
    ) -> None:
        """Accept connections."""
        self._loop, self._on_receive, self._on_disconnect = loop, on_receive, on_disconnect
        loop.add_reader(self._socket, self._accept)
        self._watch = watch_device(self.endpoint, loop, lambda: self._renew(loop))

    def send(self, data: bytes, address: Hashable) -> None:
        """Send one frame to one connection, if it still exists."""
        connection = self._connections.get(address)
        if connection:
            connection.send(data)

    def outlet(self, address: Hashable) -> Outlet | None:
        """Return the connection of this address."""
        connection = self._connections.get(address)
        return connection.outlet if connection else None

    def close(self) -> None:
        """End all connections and free the port."""
        if self._watch:
            self._watch.close()
        if self._loop:
            self._loop.remove_reader(self._socket)
        for connection in list(self._connections.values()):
            connection.close()
        self._socket.close()

    def _renew(self, loop: asyncio.AbstractEventLoop) -> bool:
        """Open the port again; False if that failed. Connections over the old interface end by their own timeout."""
        loop.remove_reader(self._socket)
        self._socket.close()
        try:
            self._socket = _open_listener(self.endpoint)
        except LinkError as error:
            self.problem = str(error)
            return False
        self.problem = None
        loop.add_reader(self._socket, self._accept)
        return True

    def _accept(self) -> None:
        try:
            sock, address = self._socket.accept()
        except BlockingIOError:
            return
        except OSError as error:
            self.problem = f"{self.endpoint.text}: {error.strerror}"
            return
        self.problem = None
        if len(self._connections) >= MAX_CONNECTIONS and not self._evict(address[0]):
            sock.close()
            return
        self._connections[address] = Connection(sock, address, self._on_receive, self._ended)
        self._on_receive([(b"", address)])  # mavutil and MAVSDK wait for a HEARTBEAT before they send theirs

    def _evict(self, host: str) -> bool:
        """Close the connection that leaves its place to a new one of `host`; False if there is none."""
        connections = list(self._connections.values())
        silent = min(connections, key=lambda each: each.last_received)
        if self._loop is None or self._loop.time() - silent.last_received < EVICT_AFTER:
            hosts = Counter(_host(each) for each in connections)
            richest, most = max(hosts.items(), key=lambda each: each[1])
            if most < max(HOST_CONNECTIONS + 1, hosts[host] + 2):
                return False
            silent = min((each for each in connections if _host(each) == richest), key=lambda each: each.last_received)
        silent.close()
        self._ended(silent, "silent")
        return True

    def _ended(self, connection: Connection, why: str) -> None:
        del self._connections[connection.address]
        self._dropped += connection.queue.dropped
        self._on_disconnect(connection.address)


def _host(connection: Connection) -> str:
    """Return the host at the other end; a connection cannot forge it."""
    address = connection.address
    return str(address[0]) if isinstance(address, tuple) else str(address)


class TcpClientTransport:
    """`tcpout`: one connection, attempted until it succeeds, and again when it has ended."""

    def __init__(self, endpoint: Endpoint, address: tuple[str, int], family: socket.AddressFamily) -> None:
        self.endpoint = endpoint
        self.problem: str | None = f"{endpoint.text}: {CONNECTING}"
        self.stream = True
        self.fixed_address: Hashable | None = endpoint.text
        self.capacity: float | None = None
        self._target = address, family
        self._resolver = Worker("resolver", limit=1)
        self._connection: Connection | None = None
        self._connecting: socket.socket | None = None
        self._timer: asyncio.TimerHandle | None = None
        self._backoff = Backoff()
        self._dropped = 0
        self._loop: asyncio.AbstractEventLoop | None = None
        self._on_receive: ReceiveCallback = lambda _: None
        self._on_disconnect: DisconnectCallback = lambda _: None

    @property
    def dropped(self) -> int:
        """Frames dropped because the connection had no room."""
        return self._dropped + (self._connection.queue.dropped if self._connection else 0)

    def start(
        self, loop: asyncio.AbstractEventLoop, on_receive: ReceiveCallback, on_disconnect: DisconnectCallback
    ) -> None:
        """Start to connect."""
        self._loop = loop
        self._on_receive, self._on_disconnect = on_receive, on_disconnect
        self._connect(loop)

    def send(self, data: bytes, address: Hashable) -> None:
        """Send one frame; without a connection it is dropped, because it would be old later."""
        if self._connection:
            self._connection.send(data)

    def outlet(self, address: Hashable) -> Outlet | None:
        """Return the connection, while there is one."""
        return self._connection.outlet if self._connection else None

    def close(self) -> None:
        """End the connection and stop connecting."""
        self._stop_connecting()
        self._resolver.close(patience=0.0)
        if self._connection:
            self._connection.close()

    def _connect(self, loop: asyncio.AbstractEventLoop) -> None:
        address, family = self._target
        sock = self._connecting = socket.socket(family, socket.SOCK_STREAM)
        sock.setblocking(False)
        self._timer = loop.call_later(CONNECT_TIMEOUT, self._refused, loop, "no answer")
        try:
            bind_to_device(sock, self.endpoint)
            sock.connect(address)
        except LinkError as error:
            self._refused(loop, str(error).removeprefix(f"{self.endpoint.text}: "))
        except BlockingIOError:
            loop.add_writer(sock, self._connected, loop, sock)
        except OSError as error:
            self._refused(loop, error.strerror or str(error))
        else:
            self._connected(loop, sock)

    def _connected(self, loop: asyncio.AbstractEventLoop, sock: socket.socket) -> None:
        error = sock.getsockopt(socket.SOL_SOCKET, socket.SO_ERROR)
        # On one machine a port without a listener can be our own end: the socket would be connected to itself.
        if error or sock.getsockname() == sock.getpeername():
            self._refused(loop, os.strerror(error) if error else "no listener")
            return
        self._connecting = None
        self._stop_connecting()
        loop.remove_writer(sock)
        self.problem = None
        self._backoff.reset()
        self._connection = Connection(sock, self.fixed_address, self._on_receive, self._ended)

    def _refused(self, loop: asyncio.AbstractEventLoop, why: str) -> None:
        self._stop_connecting()
        self._retry(loop, f"not connected ({why})")

    def _ended(self, connection: Connection, why: str) -> None:
        self._dropped += connection.queue.dropped
        self._connection = None
        self._on_disconnect(connection.address)
        if self._loop:
            self._retry(self._loop, f"connection lost ({why})")

    def _retry(self, loop: asyncio.AbstractEventLoop, what: str) -> None:
        self.problem = f"{self.endpoint.text}: {what}; trying again"
        if self._target[0][0] != self.endpoint.host:  # a host name, whose address may have changed
            self._resolver.submit(self._resolve)
        self._timer = loop.call_later(self._backoff.next_delay(), self._connect, loop)

    def _resolve(self) -> None:
        """Look the host name up, in a thread. No attempt waits for it; if it fails, the last address is kept."""
        with contextlib.suppress(LinkError):
            self._target = resolve(self.endpoint, socket.SOCK_STREAM)

    def _stop_connecting(self) -> None:
        if self._timer:
            self._timer.cancel()
        sock, self._connecting = self._connecting, None
        if sock:
            if self._loop:
                self._loop.remove_writer(sock)
            sock.close()


def open_tcpin(endpoint: Endpoint) -> TcpServerTransport:
    """Open the port. Raises LinkError."""
    return TcpServerTransport(endpoint, _open_listener(endpoint))


def _open_listener(endpoint: Endpoint) -> socket.socket:
    address, family = resolve(endpoint, socket.SOCK_STREAM)
    sock = socket.socket(family, socket.SOCK_STREAM)
    sock.setblocking(False)
    bind_to_device(sock, endpoint)
    sock.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)  # or a restart waits a minute for its own port
    try:
        sock.bind(address)
        sock.listen(MAX_CONNECTIONS)
    except OSError as error:
        sock.close()
        raise bind_error(endpoint, error) from error
    return sock


def open_tcpout(endpoint: Endpoint) -> TcpClientTransport:
    """Return a transport that connects once started. Raises LinkError if the host name is unknown."""
    return TcpClientTransport(endpoint, *resolve(endpoint, socket.SOCK_STREAM))


BULK = 65536
"""Bytes of telemetry that may wait for one connection; then the oldest is dropped."""
SEND_BUFFER = 32768
"""Bytes that the kernel buffers, where nothing can overtake; its own default grows to megabytes."""
READ = 65536
"""Bytes that one turn of the event loop reads at most."""
_KEEPIDLE: int = getattr(socket, "TCP_KEEPIDLE", None) or vars(socket)["TCP_KEEPALIVE"]
"""Linux's name, and that of macOS."""
DEAD_AFTER = 10
"""s without an acknowledgement after which the other end counts as gone; twice the vehicle's GCS timeout."""
_DROP_TIME = 0x80
"""TCP_RXT_CONNDROPTIME of macOS's <netinet/tcp.h>, s; Python does not name it."""
_GIVE_UP = (
    (socket.TCP_USER_TIMEOUT, DEAD_AFTER * 1000) if hasattr(socket, "TCP_USER_TIMEOUT") else (_DROP_TIME, DEAD_AFTER)
)
"""Option and value that end a connection whose data nobody confirms."""


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
    sock.setsockopt(socket.IPPROTO_TCP, _KEEPIDLE, DEAD_AFTER // 2)
    sock.setsockopt(socket.IPPROTO_TCP, socket.TCP_KEEPINTVL, 1)
    sock.setsockopt(socket.IPPROTO_TCP, socket.TCP_KEEPCNT, DEAD_AFTER // 2)
    sock.setsockopt(socket.IPPROTO_TCP, *_GIVE_UP)
