"""The cable of the benchmarks: it counts as copies what the ground station sends as such, and spoils frames."""

from __future__ import annotations

import os

from dialects.axes import NEUTRAL, Axes
from dialects.messages import RoverOperatorPresence
from groundstation.vehicles.demand.demand_copies import DemandCopies
from groundstation.vehicles.demand.demand_stream import DemandStream
from link.protocol.framer import Framer
from tests.benchmarks.baud_cable import Copies, Direction
from tests.benchmarks.traffic import framed

STEP = 0.001
AHEAD = Axes(throttle=0.5)


def presence(axes: Axes, milliseconds: int) -> bytes:
    x, r = round(1000 * axes.throttle), round(1000 * axes.steering)
    return framed(RoverOperatorPresence(1, 1, 5000 + milliseconds, 0, 7, 1, 0, 0, x, 32767, 32767, r), 0)


def sent_in(seconds: float, loss: float) -> tuple[int, int, int]:
    """Drive with a key pressed and released five times a second; return the bytes sent, and of copies twice."""
    stream, copies = DemandStream(DemandCopies()), Copies()
    stream.adapt(loss, 5760.0)
    total = of_copies = 0
    for step in range(round(seconds / STEP)):
        now = step * STEP
        axes = stream.next_due(AHEAD if int(now * 10) % 2 else NEUTRAL, True, now)
        if axes is not None:
            frame = presence(axes, step)
            copies.follow(frame, now)
            total += len(frame)
            of_copies += len(frame) * stream.copying
    return total, of_copies, copies.most


def test_copies_on_the_line_are_those_the_ground_station_sent() -> None:
    for loss in (0.0, 0.2):
        total, of_copies, counted = sent_in(0.95, loss)
        assert 0 < counted == of_copies < total


def test_noise_spoils_about_as_many_pieces_as_it_is_to() -> None:
    source, line = os.pipe()
    sink, target = os.pipe()
    os.set_blocking(source, False)
    frame = presence(AHEAD, 0)
    numbers = iter(range(10_000))
    cable = Direction(source, target, 5760.0, lambda: next(numbers) % 50 == 49)
    now, framer, found = 0.0, Framer(stream=True), 0
    for _ in range(100):
        os.write(line, frame)
        for _ in range(2 + len(frame) // 5):
            cable.move(now)
            now += 0.001
        found += len(framer.feed(os.read(sink, 4096), now))
    for descriptor in (source, line, sink, target):
        os.close(descriptor)
    assert 70 <= found < 95
