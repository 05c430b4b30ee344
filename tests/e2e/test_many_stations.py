"""Sixteen ground stations on one port of a real vehicle: each gets all telemetry, without loss."""

from __future__ import annotations

import select
import socket
import time
from collections.abc import Iterator
from contextlib import ExitStack
from pathlib import Path

import pytest

from dialects import codec
from dialects import messages as m
from dialects.enums import Autopilot, Command, VehicleType
from link.protocol.framer import Framer
from link.protocol.sequence import SequenceTracker
from tests.ports import free_port
from tests.vehicle.ground import running
from tests.waits import Patience

pytestmark = [pytest.mark.e2e]

STATIONS = 16


class Listener:
    """A minimal ground station: it sends a HEARTBEAT a second and counts what arrives."""

    def __init__(self, port: int, system: int) -> None:
        self.socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.socket.setsockopt(
            socket.SOL_SOCKET, socket.SO_RCVBUF, 1 << 20
        )  # for the time in which the test is delayed
        self.socket.connect(("127.0.0.1", port))
        self.socket.setblocking(False)
        self._framer = Framer(stream=False)
        self._system = system
        self._sequence = 0
        self._beat_due = 0.0
        self.source: SequenceTracker | None = None
        self.heard: dict[int, int] = {}

    def close(self) -> None:
        self.socket.close()

    def send(self, message: m.Message) -> None:
        data = codec.frame(type(message).id, codec.encode_payload(message), self._sequence, self._system, 190)
        self._sequence = (self._sequence + 1) & 0xFF
        try:
            self.socket.send(data)
        except ConnectionRefusedError:  # the vehicle has not opened its port yet
            self._beat_due = 0.0

    def listen(self) -> None:
        now = time.monotonic()
        if now >= self._beat_due:
            self._beat_due = now + (1.0 if self.source else 0.1)
            self.send(m.Heartbeat(VehicleType.GCS, Autopilot.INVALID, 0, 0, 4, 3))
        while True:
            try:
                data = self.socket.recv(2048)
            except (BlockingIOError, ConnectionRefusedError):
                return
            for message_id, _, _, sequence, raw in self._framer.feed(data, now):
                if self.source is None:
                    self.source = SequenceTracker(sequence, message_id, hash(raw), now)
                else:
                    self.source.accept(sequence, message_id, hash(raw), now)
                self.heard[message_id] = self.heard.get(message_id, 0) + 1


@pytest.fixture
def stations(tmp_path: Path) -> Iterator[list[Listener]]:
    """All of them, with a vehicle that answers them."""
    port = free_port()
    with ExitStack() as stack:
        stack.enter_context(running(tmp_path, "--sim", f"udpin:127.0.0.1:{port}"))
        found = [Listener(port, 200 + number) for number in range(STATIONS)]
        for each in found:
            stack.callback(each.close)
        yield found


def wait(stations: list[Listener], enough: int) -> None:
    """Wait until each has received this number of ATTITUDE."""
    patience = Patience()
    while any(each.heard.get(m.Attitude.id, 0) < enough for each in stations):
        assert not patience.ended, [each.heard.get(m.Attitude.id, 0) for each in stations]
        for each in stations:
            each.listen()
        select.select([each.socket for each in stations], [], [], 0.05)


def test_sixteen_stations_get_all_and_a_greedy_one_slows_nobody(stations: list[Listener]) -> None:
    wait(stations, 4)
    greedy = stations[0]
    for message in (m.Attitude, m.VfrHud, m.ServoOutputRaw):
        greedy.send(m.CommandLong(1, 1, Command.SET_MESSAGE_INTERVAL, 0, message.id, 20_000, 0, 0, 0, 0, 0))
    before = greedy.heard[m.Attitude.id]
    wait(stations, 12)
    assert greedy.heard[m.Attitude.id] - before > 2 * 8, "it asked for 50 Hz and the others have 4"
    assert [each.source.lost for each in stations if each.source] == [0] * STATIONS
    assert all({m.Heartbeat.id, m.SysStatus.id, m.GpsRawInt.id} <= each.heard.keys() for each in stations)
    assert not any(number > 46000 for each in stations for number in each.heard), "nobody asked for ours"
