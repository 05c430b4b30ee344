"""Kinds of bad network, and which one a leg has for the next seconds."""

from __future__ import annotations

import random
from collections.abc import Iterator
from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Weather:
    """What becomes of the datagrams of one leg, in both directions. Shares are 0..1, times s."""

    name: str
    loss: float = 0.0
    twice: float = 0.0
    """Share that arrives a second time, up to `late` s later."""
    damaged: float = 0.0
    """Share in which one byte is changed."""
    delay: float = 0.0
    jitter: float = 0.0
    """Each datagram is delayed by up to so much more, independently: they overtake each other."""
    late: float = 0.0
    cut: bool = False


CLEAR = Weather("clear", delay=0.005)
WEATHERS = (
    Weather("lossy", loss=0.15, delay=0.02, jitter=0.01),
    Weather("very lossy", loss=0.5, delay=0.02),
    Weather("reordered", delay=0.01, jitter=0.15),
    Weather("late", delay=0.35, jitter=0.1),
    Weather("far too late", delay=1.5, jitter=0.5),
    Weather("duplicated", twice=0.5, delay=0.01, late=2.0),
    Weather("damaged", damaged=0.2, delay=0.01),
    Weather("all at once", loss=0.05, twice=0.1, damaged=0.05, delay=0.05, jitter=0.1, late=1.0),
    Weather("cut", cut=True),
)
"""All kinds but CLEAR, which follows each of them, so that the rover drives again."""
CLEAR_FOR, BAD_FOR = (3.0, 10.0), (1.0, 6.0)
"""s, random."""


def forecast(chance: random.Random) -> Iterator[tuple[float, Weather]]:
    """Yield what the next seconds of one leg are like, for ever: each kind comes once before any comes again."""
    while True:
        for weather in chance.sample(WEATHERS, len(WEATHERS)):
            yield chance.uniform(*CLEAR_FOR), CLEAR
            yield chance.uniform(*BAD_FOR), weather


def deliveries(weather: Weather, data: bytes, chance: random.Random) -> Iterator[tuple[float, bytes]]:
    """Yield (delay, bytes) for each copy of a datagram that arrives."""
    if weather.cut or chance.random() < weather.loss:
        return
    if chance.random() < weather.damaged:
        place = chance.randrange(len(data))
        data = data[:place] + bytes([data[place] ^ chance.randrange(1, 256)]) + data[place + 1 :]
    delay = weather.delay + chance.uniform(0.0, weather.jitter)
    yield delay, data
    if chance.random() < weather.twice:
        yield delay + chance.uniform(0.0, weather.late), data
