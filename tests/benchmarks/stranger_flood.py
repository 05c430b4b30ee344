"""The strangers of the benchmark `strangers`: a process that floods a vehicle with frames until it is ended.

python -m tests.benchmarks.stranger_flood KIND PORT
"""

from __future__ import annotations

import itertools
import socket
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack
from typing import NamedTuple

from dialects import messages as m
from dialects.axes import Axes, build_manual_control
from dialects.enums import Autopilot, SystemState, VehicleType
from tests.benchmarks.traffic import framed

BEAT = m.Heartbeat(VehicleType.GCS, Autopilot.INVALID, 0, 0, SystemState.ACTIVE, 3)
BURST = 0.01
"""s between two bursts; a sender that is late sends what it owes, at most a second of it."""


class Flood(NamedTuple):
    """One kind of attack."""

    what: str
    sources: int
    """Sockets, each with a system id of its own until they run out."""
    rate: float
    """Frames/s of each."""
    build: Callable[[int], m.Message]
    """The nth message of a source."""
    beats: bool = True
    """Each source sends a HEARTBEAT first and then once a second, as one that is to be answered."""


def _unknown_name(number: int) -> m.Message:
    return m.ParamSet(1, 1, f"N{number}".encode(), 1.0, 9)


def _demand(number: int) -> m.Message:
    return build_manual_control(Axes(throttle=1.0), 1)


FLOODS = {
    "params": Flood("1 x 1000/s PARAM_SET of new names", 1, 1000.0, _unknown_name),
    "many params": Flood("8 x 750/s PARAM_SET of new names", 8, 750.0, _unknown_name),
    "modes": Flood("16 x 100/s SET_MODE", 16, 100.0, lambda number: m.SetMode(1, 1, 10 + number % 5)),
    "places": Flood("30 strangers, a HEARTBEAT each 4 s", 30, 0.25, lambda number: BEAT),
    "sources": Flood("5000 HEARTBEATs/s from 40 ports", 40, 125.0, lambda number: BEAT),
    "demands": Flood("8000/s MANUAL_CONTROL of one stranger", 1, 8000.0, _demand),
}


def flood(kind: Flood, port: int) -> None:
    """Send until the process is ended."""
    with ExitStack() as stack:
        sockets = [stack.enter_context(socket.socket(socket.AF_INET, socket.SOCK_DGRAM)) for _ in range(kind.sources)]
        for each in sockets:
            each.connect(("127.0.0.1", port))
        for number, (sender, message) in enumerate(_paced(kind)):
            _send(sockets[sender], framed(message, number // kind.sources & 0xFF, 60 + sender, 190))


def _paced(kind: Flood) -> Iterator[tuple[int, m.Message]]:
    """Yield sender and message at the rate of the flood."""
    started, sent, beat_due = time.monotonic(), 0, 0.0
    while True:
        now = time.monotonic()
        if kind.beats and now >= beat_due:
            beat_due = now + 1.0
            yield from ((sender, BEAT) for sender in range(kind.sources))
        owed = int((now - started) * kind.rate * kind.sources) - sent
        for number in itertools.islice(itertools.count(sent), min(owed, int(kind.rate * kind.sources) + 1)):
            yield number % kind.sources, kind.build(number)
        sent += max(owed, 0)
        time.sleep(BURST)


def _send(sender: socket.socket, data: bytes) -> None:
    try:
        sender.send(data)
    except (ConnectionRefusedError, BlockingIOError):
        return


if __name__ == "__main__":
    flood(FLOODS[sys.argv[1]], int(sys.argv[2]))
