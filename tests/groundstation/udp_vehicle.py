"""The vehicle of fake_vehicle.py on a real UDP socket, for a real station process."""

from __future__ import annotations

import socket
import threading
import time
from types import TracebackType

from dialects import messages as m
from link.protocol.channel import Channel
from tests.groundstation.fake_vehicle import FakeVehicle


class UdpVehicle:
    """Answers in a thread from `with` on; `core` records messages with time.monotonic()."""

    def __init__(self, endpoint: str, core: FakeVehicle | None = None) -> None:
        self.core = core or FakeVehicle()
        host, port = endpoint.removeprefix("udpin:").split(":")
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self._socket.connect((host, int(port)))
        self._socket.settimeout(0.01)
        self._channel = Channel("vehicle", 0, system=self.core.system, component=1, target="station")
        self._running = True
        self._thread = threading.Thread(target=self._run, daemon=True)

    def __enter__(self) -> UdpVehicle:
        self._thread.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._running = False
        self._thread.join()
        self._socket.close()

    def demands(self, since: float) -> list[tuple[float, int]]:
        """Return time and x of the MANUAL_CONTROL received."""
        return [(at, message.x) for at, message in self.core.all(m.ManualControl) if at >= since]

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

    def _receive(self) -> bytes:
        try:
            return self._socket.recv(65536)
        except (TimeoutError, ConnectionRefusedError):
            return b""

    def _send(self, frame: bytes) -> None:
        try:
            self._socket.send(frame)
        except ConnectionRefusedError:
            return  # the station has exited
