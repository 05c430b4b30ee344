"""UDP proxies between the programs of the soak: one thread, a leg for each program, each with a weather of its own."""

from __future__ import annotations

import heapq
import itertools
import random
import selectors
import socket
import threading
import time
from collections.abc import Callable
from functools import partial

from tests.ports import free_port
from tests.soak.weather import CLEAR, deliveries, forecast

STEP = 0.02
"""s at most between two looks at the delayed datagrams."""
Tap = Callable[[bytes, float], None]
"""Called with each datagram that a program sends, and when; monotonic."""


class Leg:
    """One program speaks to `port`, from any address; what it says goes to `target` of this machine, and back."""

    def __init__(self, name: str, target: int, tap: Tap, chance: random.Random) -> None:
        self.name = name
        self.tap = tap
        self.weather = CLEAR
        self.counts: dict[str, int] = {"datagrams": 0, "lost": 0, "copies": 0}
        self.port = free_port()
        self.near = _udp(self.port)
        self.far = _udp(0)
        self._far_address = ("127.0.0.1", target)
        self._near_address: tuple[str, int] | None = None
        self._chance = chance
        self._forecast = forecast(chance)
        self._changes_at = 0.0

    def turn(self, now: float, fair: bool) -> None:
        """Change the weather if it is time; `fair`: to clear."""
        if fair:
            self.weather, self._changes_at = CLEAR, now
        elif now >= self._changes_at:
            seconds, self.weather = next(self._forecast)
            self._changes_at = now + seconds

    def take(self, at: socket.socket, now: float) -> list[tuple[float, bytes, socket.socket, tuple[str, int]]]:
        """Read a datagram; return when its copies arrive, and where."""
        try:
            data, address = at.recvfrom(65536)
        except OSError:  # refused: the program there has been killed
            return []
        if at is self.near:
            self._near_address = address
            self.tap(data, now)
            out, to = self.far, self._far_address
        elif self._near_address is not None:
            out, to = self.near, self._near_address
        else:
            return []
        found = [(now + delay, copy, out, to) for delay, copy in deliveries(self.weather, data, self._chance)]
        self.counts["datagrams"] += 1
        self.counts["lost"] += not found
        self.counts["copies"] += max(0, len(found) - 1)
        return found


class Network:
    """All legs. `fair` ends the bad weather."""

    def __init__(self, seed: int) -> None:
        self.legs: list[Leg] = []
        self.fair = True
        self._seed = seed
        self._selector = selectors.DefaultSelector()
        self._due: list[tuple[float, int, bytes, socket.socket, tuple[str, int]]] = []
        self._number = itertools.count()
        self._running = True
        self._thread = threading.Thread(target=self._run, name="network", daemon=True)

    def add(self, name: str, target: int, tap: Tap) -> int:
        """Add a leg to a port of this machine; return the port that its program speaks to. Before `start`."""
        leg = Leg(name, target, tap, random.Random(f"{self._seed} {name}"))
        for sock in (leg.near, leg.far):
            self._selector.register(sock, selectors.EVENT_READ, partial(leg.take, sock))
        self.legs.append(leg)
        return leg.port

    def start(self) -> None:
        """Begin to forward."""
        self._thread.start()

    def close(self) -> None:
        """Stop, and close the sockets."""
        self._running = False
        self._thread.join(5)
        for leg in self.legs:
            leg.near.close()
            leg.far.close()
        self._selector.close()

    def _run(self) -> None:
        while self._running:
            left = self._due[0][0] - time.monotonic() if self._due else STEP
            ready = self._selector.select(max(0.0, min(left, STEP)))
            now = time.monotonic()
            for key, _ in ready:
                for at, data, out, to in key.data(now):
                    heapq.heappush(self._due, (at, next(self._number), data, out, to))
            self._deliver(now)
            for leg in self.legs:
                leg.turn(now, self.fair)

    def _deliver(self, now: float) -> None:
        while self._due and self._due[0][0] <= now:
            _, _, data, out, to = heapq.heappop(self._due)
            try:
                out.sendto(data, to)
            except OSError:
                continue  # refused: the program there has been killed


def _udp(port: int) -> socket.socket:
    sock = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    sock.bind(("127.0.0.1", port))
    return sock
