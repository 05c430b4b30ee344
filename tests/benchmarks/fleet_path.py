"""What the way through a fleet's router adds: frames from a ground station to a vehicle, beside plain UDP, on loopback.

The same frames of a demand go in turn through our two ends of a fleet, with a router process between them that has
certificates and access rules, and through our UDP transports. Both ends are in this process, so that one clock counts.
"""

from __future__ import annotations

import asyncio
import struct
import time
from collections.abc import Callable, Hashable, Sequence
from contextlib import ExitStack
from dataclasses import dataclass

from dialects import codec
from dialects import messages as m
from link.endpoint import Side
from link.protocol.frame import payload_of
from link.transport.transport import Transport
from link.transport.transports import open_transports
from tests.benchmarks.figures import ROUNDS, BenchmarkError, Goal, Options, Report, Spread, Table, brief, spread
from tests.benchmarks.programs import free_port, scratch
from tests.e2e.fleet_programs import RouterProcess, make_fleet

FRAMES, QUICK_FRAMES = 500, 100
RATE = 50
"""Frames/s, as a driver who holds a key with copies."""
READY_WITHIN = 10.0


@dataclass(slots=True)
class _Way:
    """One way from a ground station to a vehicle."""

    ground: Transport
    vehicle: Transport
    address: Hashable


def run(options: Options) -> Report:
    """Measure both ways in turn, round by round."""
    frames = QUICK_FRAMES if options.quick else FRAMES
    with scratch() as folder, ExitStack() as stack:
        fleet = make_fleet(folder, rover1="vehicle", alice="drive")
        RouterProcess(fleet, stack)
        port = free_port()
        endpoints = {
            "plain UDP": (f"udpin:127.0.0.1:{port}", f"udpout:127.0.0.1:{port}"),
            "fleet": (f"zenoh:{fleet}/alice.json5/farm", f"zenoh:{fleet}/rover1.json5/farm/rover1"),
        }
        taken = asyncio.run(_measure(endpoints, frames, options.say))
    return _report({name: spread(rounds) for name, rounds in taken.items()}, taken, frames)


async def _measure(
    endpoints: dict[str, tuple[str, str]], frames: int, say: Callable[[str], None]
) -> dict[str, list[list[float]]]:
    """Return the ms of each frame that arrived, round by round."""
    ways, arrived = {}, {name: list[tuple[float, int]]() for name in endpoints}
    for name, texts in endpoints.items():
        ways[name] = await _open(name, texts, arrived[name])
    taken: dict[str, list[list[float]]] = {name: [] for name in endpoints}
    try:
        for turn in range(ROUNDS):
            for name, way in ways.items():
                say(f"fleet_path: round {turn + 1} of {ROUNDS}, {name}")
                taken[name].append(await _run_round(way, arrived[name], frames))
    finally:
        for way in ways.values():
            way.ground.close()
            way.vehicle.close()
    return taken


async def _open(name: str, texts: tuple[str, str], arrived: list[tuple[float, int]]) -> _Way:
    [ground], [vehicle] = open_transports([texts[0]], Side.GROUND_STATION), open_transports([texts[1]], Side.VEHICLE)
    loop, met = asyncio.get_running_loop(), asyncio.Event()
    peers: list[Hashable] = []

    def meet(pieces: Sequence[tuple[bytes, Hashable]]) -> None:
        peers.extend(address for _, address in pieces)
        met.set()

    def take(pieces: Sequence[tuple[bytes, Hashable]]) -> None:
        now = time.monotonic()
        arrived.extend((now, _number(data)) for data, _ in pieces if data)

    ground.start(loop, meet, lambda _: None)
    vehicle.start(loop, take, lambda _: None)
    until = loop.time() + READY_WITHIN
    while not met.is_set():
        if vehicle.fixed_address is not None:
            vehicle.send(_frame(0), vehicle.fixed_address)
        if loop.time() > until:
            raise BenchmarkError(f"{name}: the two ends have not met within {READY_WITHIN:g} s")
        await asyncio.sleep(0.1)
    await asyncio.sleep(1.0)
    return _Way(ground, vehicle, peers[0])


async def _run_round(way: _Way, arrived: list[tuple[float, int]], frames: int) -> list[float]:
    arrived.clear()
    sent: dict[int, float] = {}
    begun = time.monotonic()
    for each in range(1, frames + 1):
        await asyncio.sleep(max(0.0, begun + each / RATE - time.monotonic()))
        sent[each] = time.monotonic()
        way.ground.send(_frame(each), way.address)
    await asyncio.sleep(0.5)
    return [1000 * (at - sent[each]) for at, each in arrived if each in sent]


def _frame(count: int) -> bytes:
    """Return a demand that carries its number."""
    return codec.frame(m.ManualControl.id, codec.encode_payload(m.ManualControl(1, 0, 0, 0, 0, count)), count & 255,
                       255, 190)  # fmt: skip


def _number(data: bytes) -> int:
    """Return the number of a demand: its field `buttons`, the last but `target` of those in the first version."""
    payload = payload_of(data).ljust(11, b"\0")
    [count] = struct.unpack_from("<H", payload, 8)
    return int(count)


def _report(spreads: dict[str, Spread], taken: dict[str, list[list[float]]], frames: int) -> Report:
    rows = [
        {
            "way": name,
            "frames": each.samples,
            "lost": frames * ROUNDS - sum(map(len, taken[name])),
            "p50 ms": each.p50,
            "p99 ms": each.p99,
            "max ms": each.max,
        }
        for name, each in spreads.items()
    ]
    plain, fleet = spreads["plain UDP"], spreads["fleet"]
    goals = [
        Goal("added by the fleet path, p50", fleet.p50 - plain.p50, 0.6, "ms", False, f"UDP, {brief(plain.p50)} ms"),
        Goal("added by the fleet path, p99", fleet.p99 - plain.p99, 3.0, "ms", False, f"UDP, {brief(plain.p99)} ms"),
    ]
    note = f"A demand of {RATE} Hz, put to handed over. The fleet: TLS with certificates, access rules, one router."
    return Report([Table("From a ground station to a vehicle, on loopback", rows, note)], goals)
