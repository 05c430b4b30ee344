"""A bad network between two programs: one UDP relay process that delays, loses and reorders datagrams.

Usage: python -m tests.benchmarks.lossy_relay VEHICLE_SIDE GROUND LOSS DELAY JITTER [reorder]

VEHICLE_SIDE is a port of ours, GROUND that of the ground station, both HOST:PORT or a port of loopback. Times in s,
LOSS 0..1. With `reorder` datagrams overtake each other within the jitter.
"""

from __future__ import annotations

import contextlib
import heapq
import random
import select
import socket
import sys
import time

from link.transport.memory import LossyPipe

STEP = 0.0005
"""s at least between two looks at delayed datagrams: short beside the delay."""

LOCALHOST = "127.0.0.1"

Address = tuple[str, int]
Pipe = LossyPipe[bytes]


class Relay:
    """The vehicle sends to `vehicle_port`, which is ours; we forward to the ground station at `ground_port`."""

    def __init__(self, vehicle: Address, ground: Address, pipes: tuple[Pipe, Pipe]) -> None:
        self._vehicle = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self._vehicle.bind(vehicle)
        self._ground = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self._ground.connect(ground)
        self._up, self._down = pipes
        self._vehicle_address: tuple[str, int] | None = None

    def run(self) -> None:
        """Run until killed."""
        while True:
            now = time.monotonic()
            due = [at for at in (self._up.next_arrival, self._down.next_arrival) if at is not None]
            timeout = max(STEP, min(due) - now) if due else None
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

    def _pass_on(self, now: float) -> None:
        for data in self._down.receive(now):
            with contextlib.suppress(ConnectionRefusedError):
                self._ground.send(data)
        for data in self._up.receive(now):
            if self._vehicle_address:
                self._vehicle.sendto(data, self._vehicle_address)


class ReorderingPipe(LossyPipe[bytes]):
    """One direction in which each datagram has a delay of its own, so that they overtake each other."""

    def __init__(self, *, delay: float, jitter: float, loss: float, seed: int) -> None:
        super().__init__(delay=delay, jitter=jitter, loss=loss, seed=seed)
        self._chance = random.Random(seed)
        self._flying: list[tuple[float, int, bytes]] = []
        self._count = 0

    @property
    def next_arrival(self) -> float | None:
        """When the next datagram arrives; None while none is under way."""
        return self._flying[0][0] if self._flying else None

    def send(self, data: bytes, now: float) -> None:
        """Send `data`, or lose it."""
        if self._chance.random() < self.loss:
            return
        self._count += 1
        arrival = now + max(0.0, self.delay + self._chance.uniform(-self.jitter, self.jitter))
        heapq.heappush(self._flying, (arrival, self._count, data))

    def receive(self, now: float) -> list[bytes]:
        """Return what has arrived by now."""
        arrived = []
        while self._flying and self._flying[0][0] <= now:
            arrived.append(heapq.heappop(self._flying)[2])
        return arrived


def _address(text: str) -> Address:
    host, _, port = text.rpartition(":")
    return host or LOCALHOST, int(port)


def main(vehicle: str, ground: str, loss: float, delay: float, jitter: float, *, reorder: bool) -> None:
    """Run until killed."""
    kind: type[Pipe] = ReorderingPipe if reorder else LossyPipe[bytes]
    up, down = (kind(loss=loss, delay=delay, jitter=jitter, seed=seed) for seed in (1, 2))
    relay = Relay(_address(vehicle), _address(ground), (up, down))
    print("relay ready", flush=True)
    relay.run()


if __name__ == "__main__":
    main(sys.argv[1], sys.argv[2], *map(float, sys.argv[3:6]), reorder="reorder" in sys.argv[6:])
