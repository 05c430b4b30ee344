"""A bad network between two programs on loopback: one UDP relay process that delays and loses datagrams.

Usage: python -m tests.benchmarks.lossy_relay VEHICLE_SIDE_PORT GROUND_PORT LOSS DELAY JITTER (s; LOSS 0..1)
"""

from __future__ import annotations

import contextlib
import select
import socket
import sys
import time

from link.transport.memory import LossyPipe

STEP = 0.0005
"""s between two polls of the delayed datagrams: short beside the delay, and only while there are any."""

LOCALHOST = "127.0.0.1"


class Relay:
    """The vehicle sends to `vehicle_port`, which is ours; we forward to the ground station at `ground_port`."""

    def __init__(self, vehicle_port: int, ground_port: int, pipes: tuple[LossyPipe[bytes], LossyPipe[bytes]]) -> None:
        self._vehicle = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self._vehicle.bind((LOCALHOST, vehicle_port))
        self._ground = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self._ground.connect((LOCALHOST, ground_port))
        self._up, self._down = pipes
        self._vehicle_address: tuple[str, int] | None = None
        self._busy_until = 0.0

    def run(self) -> None:
        """Run until killed."""
        while True:
            now = time.monotonic()
            timeout = STEP if now < self._busy_until else None
            ready, _, _ = select.select([self._vehicle, self._ground], [], [], timeout)
            self._take(ready, time.monotonic())
            self._pass_on(time.monotonic())

    def _take(self, ready: list[socket.socket], now: float) -> None:
        if self._vehicle in ready:
            data, self._vehicle_address = self._vehicle.recvfrom(65536)
            self._down.send(data, now)
        if self._ground in ready:
            with contextlib.suppress(ConnectionRefusedError):  # the ground station is not there yet
                self._up.send(self._ground.recv(65536), now)
        if ready:
            self._busy_until = now + 2 * (self._up.delay + self._up.jitter) + STEP

    def _pass_on(self, now: float) -> None:
        for data in self._down.receive(now):
            with contextlib.suppress(ConnectionRefusedError):
                self._ground.send(data)
        for data in self._up.receive(now):
            if self._vehicle_address:
                self._vehicle.sendto(data, self._vehicle_address)


def main(vehicle_port: int, ground_port: int, loss: float, delay: float, jitter: float) -> None:
    """Run until killed."""
    pipes = (
        LossyPipe[bytes](loss=loss, delay=delay, jitter=jitter, seed=1),
        LossyPipe[bytes](loss=loss, delay=delay, jitter=jitter, seed=2),
    )
    relay = Relay(vehicle_port, ground_port, pipes)
    print("relay ready", flush=True)
    relay.run()


if __name__ == "__main__":
    main(int(sys.argv[1]), int(sys.argv[2]), *map(float, sys.argv[3:6]))
