"""One HEARTBEAT with a forged address: how much a real vehicle sends to who never asked for anything."""

from __future__ import annotations

import socket
from pathlib import Path

import pytest

from dialects import codec
from dialects import messages as m
from link.protocol.framer import Framer
from tests.e2e.programs import Vehicle
from tests.link.frames import frame, heartbeat
from tests.ports import free_port
from tests.waits import wait_until

pytestmark = [pytest.mark.slow, pytest.mark.e2e]


def hear(sock: socket.socket) -> list[bytes]:
    """All datagrams until 3 s of silence: while the vehicle knows the address, it sends a HEARTBEAT a second."""
    found = []
    try:
        while True:
            found.append(sock.recv(4096))
    except TimeoutError:
        return found


@pytest.mark.parametrize("answers", [False, True])
def test_one_heartbeat_brings_little_unless_it_answers(tmp_path: Path, answers: bool) -> None:
    port = free_port()
    vehicle = Vehicle(tmp_path, f"udpin:127.0.0.1:{port}")
    try:
        wait_until(lambda: "ready" in vehicle.errors.read_text())
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as victim:
            victim.settimeout(3.0)
            victim.connect(("127.0.0.1", port))
            victim.send(heartbeat(0))
            framer, heard = Framer(stream=False), b""
            while answers:
                data = victim.recv(4096)
                heard += data
                found = (codec.decode_frame(each[0], each[4]) for each in framer.feed(data, 0.0))
                if ping := next((each for each in found if isinstance(each, m.Ping)), None):
                    victim.send(frame(m.Ping(ping.time_usec, ping.seq, 1, 1), 1))
                    break
            size = len(heard) + sum(len(data) for data in hear(victim))
    finally:
        vehicle.end()
    if answers:
        assert size > 8000, "about 1.1 kB/s for 10 s"
    else:
        assert size < 2100 + 12 * 21 + 6 * 60, "a hundred times what came, HEARTBEATs and questions"
