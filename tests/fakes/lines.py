"""Fake vehicles on real lines: UDP, TCP, or a pseudo-terminal as serial port, for programs under test."""

from __future__ import annotations

import os
import pty
import random
import select
import socket
import threading
import time
import tty
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from typing import Protocol, TypeVar

from dialects import messages as m
from tests.fakes.vehicle import FakeVehicle
from tests.fakes.wires import ChannelWire, Wire
from tests.ports import free_port

LINES = ("udpin", "udpout", "tcpin", "tcpout", "serial")
"""The program's end of the line."""
LOOK = 0.01
"""s between two looks at the time while nothing arrives."""
BURST, PAUSE = 100, 0.005
"""Frames that a socket buffer holds, and s until the reader has had time for them."""
VehicleT = TypeVar("VehicleT", bound=FakeVehicle)


@contextmanager
def on_line(
    vehicle: VehicleT,
    line: str = "udpout",
    *,
    endpoint: str = "",
    wire: Wire | None = None,
    loss: float = 0.0,
    loss_in: float = 0.0,
) -> Iterator[VehicleT]:
    """Run the vehicle in a thread, on a line; `vehicle.endpoint` is for the program under test.

    `endpoint`: reach a program that listens at this `udpin:` endpoint, or open the device of this path, in place of a
    new line. `loss` is the share of what it sends that is lost, but for heartbeats, `loss_in` that of what is sent to
    it. The vehicle's time is time.monotonic(). On "udpout" it is silent until the program has sent something.
    """
    run = _Run(vehicle, _open(line, endpoint), wire or ChannelWire(), loss, loss_in)
    thread = threading.Thread(target=run, name=f"vehicle {vehicle.system}", daemon=True)
    thread.start()
    try:
        yield vehicle
    finally:
        run.ended.set()
        thread.join()
        run.end.close()


class _Run:
    """The vehicle's loop, in its thread."""

    def __init__(self, vehicle: FakeVehicle, end: _End, wire: Wire, loss: float, loss_in: float) -> None:
        self.end, self.ended = end, threading.Event()
        self._vehicle, self._wire = vehicle, wire
        self._loss, self._loss_in = loss, loss_in
        self._dice = random.Random(3)
        vehicle.endpoint = end.endpoint
        wire.open(vehicle.system, vehicle.component, stream=not isinstance(end, _Udp))

    def __call__(self) -> None:
        while not self.ended.is_set():
            data, now = self.end.read(), time.monotonic()
            if data and self._dice.random() >= self._loss_in:
                for received in self._wire.receive(data, now):
                    self._vehicle.receive(received, now)
            if self.end.connected:
                self._vehicle.tick(now)
                self._write(now)

    def _write(self, now: float) -> None:
        for count, outgoing in enumerate(self._vehicle.messages_to_send(), 1):
            certain = isinstance(outgoing.message, m.Heartbeat)
            for frame in self._wire.frames(outgoing, now):
                if certain or self._dice.random() >= self._loss:
                    self.end.write(frame)
            if count % BURST == 0:
                time.sleep(PAUSE)


class _End(Protocol):
    """The vehicle's end of a line."""

    endpoint: str

    @property
    def connected(self) -> bool: ...

    def read(self) -> bytes: ...

    def write(self, data: bytes) -> None: ...

    def close(self) -> None: ...


def _open(line: str, endpoint: str) -> _End:
    if endpoint.startswith("udpin:"):
        return _Udp("udpin", int(endpoint.rpartition(":")[2]))
    if endpoint or line == "serial":
        return _Serial(endpoint)
    return _Udp(line, free_port()) if line.startswith("udp") else _Tcp(line, free_port())


class _Udp:
    """A socket; "udpout" waits for the program's first datagram."""

    def __init__(self, line: str, port: int) -> None:
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self._socket.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 1 << 20)
        self._socket.settimeout(LOOK)
        self._peer: tuple[str, int] | None = None
        if line == "udpin":
            self._peer = ("127.0.0.1", port)
            self._socket.connect(self._peer)  # so that only this program is read
        else:
            self._socket.bind(("127.0.0.1", port))
        self._line = line
        self.endpoint = f"{line}:127.0.0.1:{port}"

    @property
    def connected(self) -> bool:
        return self._peer is not None

    def read(self) -> bytes:
        try:
            data, address = self._socket.recvfrom(65536)
        except (TimeoutError, ConnectionRefusedError):
            return b""
        self._peer = address
        return data

    def write(self, data: bytes) -> None:
        with suppress(ConnectionRefusedError):  # the program has exited
            if self._line == "udpin":
                self._socket.send(data)
            elif self._peer is not None:
                self._socket.sendto(data, self._peer)

    def close(self) -> None:
        self._socket.close()


class _Tcp:
    """A connection, made again whenever it ends."""

    def __init__(self, line: str, port: int) -> None:
        self._port = port
        self._peer: socket.socket | None = None
        self._listener = socket.create_server(("127.0.0.1", port)) if line == "tcpout" else None
        self.endpoint = f"{line}:127.0.0.1:{port}"

    @property
    def connected(self) -> bool:
        return self._peer is not None

    def _connect(self) -> None:
        if self._listener is not None:
            if select.select([self._listener], [], [], LOOK)[0]:
                self._peer, _ = self._listener.accept()
            return
        try:
            self._peer = socket.create_connection(("127.0.0.1", self._port), timeout=0.1)
        except OSError:
            select.select([], [], [], LOOK)

    def read(self) -> bytes:
        if self._peer is None:
            self._connect()
        if self._peer is None or not select.select([self._peer], [], [], LOOK)[0]:
            return b""
        try:
            return self._peer.recv(65536)
        except OSError:
            return b""

    def write(self, data: bytes) -> None:
        if self._peer is not None:
            with suppress(OSError):  # nobody is there yet, or any more
                self._peer.send(data)

    def close(self) -> None:
        for each in (self._listener, self._peer):
            if each is not None:
                each.close()


class _Serial:
    """A pseudo-terminal; or a device that exists, by its path."""

    connected = True

    def __init__(self, path: str = "") -> None:
        self._near = -1
        if path:
            self._file = os.open(path, os.O_RDWR | os.O_NOCTTY)
            tty.setraw(self._file)
        else:
            self._file, self._near = pty.openpty()  # our end, and the port, kept open between two programs
            tty.setraw(self._near)
            path = os.ttyname(self._near)
        self.endpoint = f"serial:{path}:57600"

    def read(self) -> bytes:
        return os.read(self._file, 65536) if select.select([self._file], [], [], LOOK)[0] else b""

    def write(self, data: bytes) -> None:
        os.write(self._file, data)

    def close(self) -> None:
        os.close(self._file)
        if self._near >= 0:
            os.close(self._near)
