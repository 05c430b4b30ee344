"""A kept station with two links to one vehicle: it goes on over either link, and its recording has everything once."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from collections import Counter
from collections.abc import Iterator
from contextlib import ExitStack
from pathlib import Path

import pytest

from dialects import codec
from dialects.messages import MESSAGES, Attitude, LocalPositionNed, Message
from groundstation.intents.session import Quit
from link.tlog.tlog import read_records
from tests.e2e.programs import Vehicle
from tests.e2e.relay import Relay
from tests.groundstation.killed_screen import ROOT
from tests.groundstation.screen import Screen, running
from tests.waits import wait_until

pytestmark = pytest.mark.e2e

CUT = 2.0
"""s for which each link is cut in turn: longer than FS_TIMEOUT, after which a rover without a driver holds."""


class KeptStation:
    """A vehicle, two relays to a station, and the screen process that began it."""

    def __init__(self, folder: Path, stack: ExitStack) -> None:
        self.logs = folder / "logs"
        self.relays = [Relay(), Relay()]
        for relay in self.relays:
            stack.callback(relay.close)
        first, second = (f"udpout:127.0.0.1:{relay.vehicle_port}" for relay in self.relays)
        self.vehicle = Vehicle(folder, first, second)
        stack.callback(self.vehicle.end)
        endpoints = [f"udpin:127.0.0.1:{relay.ground_port}" for relay in self.relays]
        command = [sys.executable, "-m", "tests.groundstation.parent", *endpoints, "--keep", f"--record-to={self.logs}"]
        self.parent = subprocess.Popen(command, stdout=subprocess.PIPE, cwd=ROOT)
        stack.callback(self.parent.wait)
        stack.callback(self.parent.kill)
        assert self.parent.stdout is not None
        stack.callback(self.parent.stdout.close)
        self.process = int(self.parent.stdout.readline())
        stack.callback(self._end)

    def _end(self) -> None:
        if running(self.process):
            os.kill(self.process, signal.SIGKILL)

    def recorded(self) -> list[Message]:
        """Return the messages of the vehicle in all logs."""
        files = sorted(self.logs.glob("*.tlog"))
        frames = [record.raw for file in files for record in read_records(file.read_bytes())]
        numbers = [(int.from_bytes(raw[7:10], "little"), raw) for raw in frames if raw[5] == 1]
        return [codec.decode_frame(number, raw) for number, raw in numbers if number in MESSAGES]


@pytest.fixture
def kept(tmp_path: Path) -> Iterator[KeptStation]:
    with ExitStack() as stack:
        yield KeptStation(tmp_path, stack)


def test_a_kept_station_drives_and_records_over_two_links(kept: KeptStation) -> None:
    vehicle = kept.vehicle
    wait_until(lambda: any(each.turning for each in vehicle.outputs()))
    kept.parent.kill()
    wait_until(vehicle.stands)
    with Screen.attach(kept.process) as screen:
        screen.hold_forward()
        screen.turn_wheels(vehicle.turning)
        for relay in kept.relays:
            relay.cut()
            cut_at = time.monotonic()
            screen.see(lambda seen, cut_at=cut_at: time.monotonic() - cut_at > CUT)  # type: ignore[misc]
            screen.turn_wheels(vehicle.turning)
            relay.cut(False)
        screen.client.send(Quit(disarm=True))
        wait_until(lambda: not running(kept.process))
    wait_until(vehicle.stands)
    recorded = kept.recorded()
    for kind in (Attitude, LocalPositionNed):
        times = Counter(each.time_boot_ms for each in recorded if isinstance(each, kind))
        assert len(times) > 10
        assert set(times.values()) == {1}
