"""A scripted vehicle on a real line (UDP, TCP or a pseudo-terminal as serial port), for a real station process."""

from __future__ import annotations

import os
import pty
import select
import socket
import threading
import time
import tty
from types import TracebackType

from link.protocol.channel import Channel
from tests.groundstation.fake_vehicle import FakeVehicle
from tests.ports import free_port

LINES = ("udpin", "udpout", "tcpin", "tcpout", "serial")
"""The station's end of the line."""


class LineVehicle:
    """Answers in a thread from `with` on. `endpoint` is for the station; start it within the block."""

    def __init__(self, core: FakeVehicle, line: str) -> None:
        self.core = core
        self._line = line
        self._port = free_port()
        self._file = self._socket = -1
        self._listener: socket.socket | None = None
        self._peer: socket.socket | None = None
        self.endpoint = self._open()
        self._channel = Channel("vehicle", 0, system=1, component=1, target="station", stream=True)
        self._running = True
        self._thread = threading.Thread(target=self._run, daemon=True)

    def __enter__(self) -> LineVehicle:
        self._thread.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._running = False
        self._thread.join()
        for each in (self._listener, self._peer):
            if each is not None:
                each.close()
        if self._line == "serial":
            os.close(self._file)
            os.close(self._socket)

    def _open(self) -> str:
        """Open our end; return the station's endpoint."""
        here = ("127.0.0.1", self._port)
        if self._line == "serial":
            self._file, self._socket = pty.openpty()  # our end, and the port, kept open between two stations
            tty.setraw(self._socket)
            return f"serial:{os.ttyname(self._socket)}:57600"
        if self._line.startswith("udp"):
            self._peer = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
            if self._line == "udpin":
                self._peer.connect(here)
            else:
                self._peer.bind(here)
        elif self._line == "tcpout":
            self._listener = socket.create_server(here)
        return f"{self._line}:127.0.0.1:{self._port}"

    def _run(self) -> None:
        while self._running:
            data = self._receive()
            now = time.monotonic()
            for received in self._channel.receive(data, "station", now) if data else ():
                self.core.receive(received, now)
            self.core.tick(now)
            for outgoing in self.core.messages_to_send():
                for frame, _, _ in self._channel.send(outgoing):
                    self._send(frame)

    def _connected(self) -> bool:
        """Connect a TCP line when the other end is there."""
        if self._peer is None and self._listener is not None and select.select([self._listener], [], [], 0.01)[0]:
            self._peer, _ = self._listener.accept()
        elif self._peer is None and self._line == "tcpin":
            try:
                self._peer = socket.create_connection(("127.0.0.1", self._port), timeout=0.1)
            except OSError:
                select.select([], [], [], 0.01)
        return self._peer is not None

    def _receive(self) -> bytes:
        if self._line == "serial":
            return os.read(self._file, 65536) if select.select([self._file], [], [], 0.01)[0] else b""
        if not self._connected() or self._peer is None or not select.select([self._peer], [], [], 0.01)[0]:
            return b""
        try:
            data, address = self._peer.recvfrom(65536)
        except OSError:
            return b""
        if self._line == "udpout" and address:
            self._peer.connect(address)
        return data

    def _send(self, frame: bytes) -> None:
        if self._line == "serial":
            os.write(self._file, frame)
        elif self._peer is not None:
            try:
                self._peer.send(frame)
            except OSError:
                return  # nobody is there yet, or any more
