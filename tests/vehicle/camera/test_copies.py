"""The camera sends each packet as often as its settings say."""

from __future__ import annotations

import asyncio
import contextlib
import socket
import time

from link.services.video_stream import COPY_PAYLOAD_TYPE, PAYLOAD_TYPE
from tests.waits import until
from vehicle.camera.copies import COPY_DELAY
from vehicle.camera.process import Relay


def packet(number: int, kind: int) -> bytes:
    """The last packet of a picture."""
    return bytes([0x80, 0x80 | kind]) + number.to_bytes(2, "big") + bytes(8) + b"\x41picture"


async def pass_time() -> None:
    """Let the time pass in which copies come."""
    end = time.monotonic() + 3 * COPY_DELAY
    await until(lambda: time.monotonic() > end)


def test_each_packet_is_sent_as_often_as_the_settings_say() -> None:
    async def send(copies: int) -> None:
        with (
            contextlib.closing(Relay(copies)) as relay,
            socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as station,
        ):
            station.bind(("127.0.0.1", 0))
            station.setblocking(False)
            relay.targets = (station.getsockname(),)
            got: list[bytes] = []

            def receive() -> int:
                with contextlib.suppress(BlockingIOError):
                    while True:
                        got.append(station.recv(2048))
                return len(got)

            firsts = [packet(number, PAYLOAD_TYPE) for number in range(5)]
            for each in [b"short", packet(0, 72), *firsts]:
                relay.datagram_received(each, None)
            assert receive() == 5
            assert got == firsts, "at once"
            await until(lambda: receive() == 5 * copies)
            await pass_time()  # no more come
            assert receive() == 5 * copies
            assert got[5:] == [packet(number, COPY_PAYLOAD_TYPE) for number in range(5)] * (copies - 1)
            assert (relay.pictures, relay.bits) == (5, 8 * copies * sum(map(len, firsts)))
            relay.datagram_received(firsts[0], None)
            relay.targets = ()  # nobody watches any more
            await pass_time()
            assert receive() == 5 * copies + 1

    for copies in (2, 1, 3):
        asyncio.run(send(copies))
