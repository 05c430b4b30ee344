"""Faults between a real socket and its reader: a vehicle and a ground station that suffer from them."""

from __future__ import annotations

import asyncio
import socket
import time
from collections.abc import Sequence

from link.endpoint import Side
from link.transport.faults.faulty_transport import LinkFaults
from link.transport.faults.settings import CUT_AFTER, FaultSettings
from link.transport.transport import Transport
from link.transport.transports import open_transports
from tests.ports import free_port
from tests.waits import until


class Ends:
    """Two ends of a link on the loopback, the first with faults."""

    def __init__(self, scheme: str, settings: FaultSettings) -> None:
        self.port = port = free_port()
        self.faults = LinkFaults(settings)
        (far,) = open_transports([f"{scheme}in:127.0.0.1:{port}"], Side.GROUND_STATION)
        (near,) = open_transports([f"{scheme}out:127.0.0.1:{port}"], Side.VEHICLE)
        self.near: Transport = self.faults.wrap(near)
        self.far = far
        self.heard: dict[str, list[bytes]] = {"near": [], "far": []}
        self.far_address: object = None
        loop = asyncio.get_running_loop()
        self.far.start(loop, self._hear_far, lambda address: None)
        self.near.start(loop, lambda batch: self._hear("near", batch), lambda address: None)

    def _hear(self, end: str, batch: Sequence[tuple[bytes, object]]) -> None:
        self.heard[end] += [data for data, _ in batch if data]

    def _hear_far(self, batch: Sequence[tuple[bytes, object]]) -> None:
        self.far_address = batch[-1][1]
        self._hear("far", batch)

    def say(self, data: bytes) -> None:
        """Send from the end with faults."""
        self.near.send(data, self.near.fixed_address)

    def answer(self, data: bytes) -> None:
        """Send to it."""
        self.far.send(data, self.far_address)

    def close(self) -> None:
        """Close both."""
        self.near.close()
        self.far.close()


async def test_both_directions_are_late() -> None:
    ends = Ends("udp", FaultSettings(delay=0.1))
    try:
        sent = time.monotonic()
        ends.say(b"up")
        await until(lambda: ends.heard["far"])
        ends.answer(b"down")
        await until(lambda: ends.heard["near"])
        assert time.monotonic() - sent >= 0.2
        assert (ends.heard["far"], ends.heard["near"]) == ([b"up"], [b"down"])
    finally:
        ends.close()


async def frames_that_pass(seed: int) -> list[int]:
    """Return which of 200 frames pass a link that loses a fifth."""
    ends = Ends("udp", FaultSettings(loss=0.2, seed=seed))
    try:
        for frame in range(200):
            ends.say(bytes([frame]))
        ends.near.close()
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sock:
            sock.sendto(b"end", ("127.0.0.1", ends.port))
        await until(lambda: ends.heard["far"][-1:] == [b"end"])
        return [data[0] for data in ends.heard["far"][:-1]]
    finally:
        ends.far.close()


async def test_loss_is_as_asked_for_and_the_same_again() -> None:
    first = await frames_that_pass(1)
    assert 140 <= len(first) <= 175
    assert await frames_that_pass(1) == first
    assert await frames_that_pass(7) != first


async def test_a_cut_lets_nothing_pass_and_ends() -> None:
    ends = Ends("udp", FaultSettings(cut=0.2))
    loop = asyncio.get_running_loop()
    try:
        ends.say(b"before")
        await until(lambda: ends.heard["far"] == [b"before"])
        begun = loop.time()
        ends.faults.update(True, begun - CUT_AFTER)
        ends.faults.update(True, begun)
        ends.say(b"during")
        await until(lambda: loop.time() > begun + 0.2)
        ends.say(b"after")
        await until(lambda: len(ends.heard["far"]) > 1)
        assert ends.heard["far"] == [b"before", b"after"]
    finally:
        ends.close()


async def test_a_connection_is_made_and_its_bytes_are_late() -> None:
    ends = Ends("tcp", FaultSettings(delay=0.05))
    try:
        await until(lambda: ends.far_address is not None)
        sent = time.monotonic()
        ends.answer(b"x")
        await until(lambda: ends.heard["near"])
        assert time.monotonic() - sent >= 0.05
    finally:
        ends.close()


async def test_a_copy_of_the_socket_is_not_given_away() -> None:
    ends = Ends("udp", FaultSettings(loss=1.0))
    try:
        assert ends.far.outlet("127.0.0.1") is not None
        assert ends.near.outlet(ends.near.fixed_address) is None
    finally:
        ends.close()
