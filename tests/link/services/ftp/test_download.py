"""Downloads that are resumed, and the checksum at their end."""

from __future__ import annotations

import random
from typing import Any

import pytest

from link.services.ftp.client import FtpClient
from link.services.ftp.download import CHANGED
from link.services.ftp.job import FtpOutcome
from link.services.ftp.protocol import FtpError, FtpOpcode, crc32, parse_packet
from tests.link.ftp_rig import FtpRig
from tests.link.services_world import Pair

DATA = random.Random(7).randbytes(20_000)


class Watched:
    """The vehicle's server; keeps the opcodes and offsets that it was asked for, and may not know some."""

    def __init__(self, vehicle: FtpRig, unknown: frozenset[FtpOpcode] = frozenset()) -> None:
        self.vehicle, self.unknown = vehicle, unknown
        self.asked: list[tuple[int, int]] = []

    def receive(self, received: Any, now: float) -> list[Any]:
        packet = parse_packet(received.message)
        self.asked.append((packet.op, packet.offset))
        return [] if packet.op in self.unknown else self.vehicle.server.receive(received, now)

    def tick(self, now: float) -> list[Any]:
        return self.vehicle.server.tick(now)


def fetch(server: Watched, loss: float = 0.0, **how: Any) -> FtpOutcome:
    client = FtpClient(255, 190, target_system=1)
    pair = Pair(server, client, loss=loss, seed=2)
    client.download("/logs/1.bin", pair.now, **how)
    pair.run_until(lambda: not client.busy, 60.0)
    [outcome] = client.outcomes()
    return outcome


def test_a_download_is_resumed_behind_what_has_arrived() -> None:
    server = Watched(FtpRig(logs={"1.bin": DATA}))
    outcome = fetch(server, have=DATA[:12_345], verify=True)
    assert outcome.done
    assert outcome.data == DATA
    assert outcome.checksum == crc32(DATA)
    assert min(offset for op, offset in server.asked if op == FtpOpcode.BURST) == 12_345


def test_what_was_kept_of_another_file_is_noticed() -> None:
    outcome = fetch(Watched(FtpRig(logs={"1.bin": DATA})), have=b"x" * 500, verify=True)
    assert (outcome.done, outcome.problem) == (False, CHANGED)


class Growing(Watched):
    """The log that is being written: longer each time that its checksum is asked for."""

    def __init__(self, times: int, *, first: bytes = b"") -> None:
        self.logs = {"1.bin": DATA}
        self._times, self._first = times, first
        super().__init__(FtpRig(logs=self.logs))

    def receive(self, received: Any, now: float) -> list[Any]:
        if parse_packet(received.message).op == FtpOpcode.CRC and self._times > 0:
            self._times -= 1
            data = self.vehicle.logs["1.bin"]
            self.vehicle.logs["1.bin"] = (self._first or data[:1]) + data[1:] + bytes(500)
        return super().receive(received, now)


@pytest.mark.parametrize(("times", "loss"), [(1, 0.1), (8, 0.0)])
def test_a_file_that_grows_meanwhile_is_followed_to_its_end(times: int, loss: float) -> None:
    outcome = fetch(Growing(times), loss=loss, verify=True)
    assert outcome.done, outcome.problem
    assert outcome.data == DATA + bytes(500 * times)


@pytest.mark.parametrize(("times", "first"), [(9, b""), (1, b"?")])
def test_a_file_that_never_rests_or_also_changes_is_refused(times: int, first: bytes) -> None:
    outcome = fetch(Growing(times, first=first), verify=True)
    assert (outcome.done, outcome.problem) == (False, CHANGED)


@pytest.mark.parametrize("have", [DATA, DATA + b"more"])
def test_whole_file_is_only_compared_and_longer_one_fetched_anew(have: bytes) -> None:
    server = Watched(FtpRig(logs={"1.bin": DATA}))
    outcome = fetch(server, have=have, verify=True)
    assert outcome.done
    assert outcome.data == DATA
    assert (FtpOpcode.BURST in {op for op, _ in server.asked}) == (have != DATA)


def test_beginning_of_a_file_is_kept_when_the_vehicle_is_silent() -> None:
    vehicle = FtpRig(logs={"1.bin": DATA}, rate=10_000.0)
    client = FtpClient(255, 190, target_system=1)
    pair = Pair(vehicle.server, client)
    client.download("/logs/1.bin", pair.now)
    pair.run_until(lambda: client.progress[0] > 5000, within=5.0)
    for second in range(60):
        client.tick(pair.now + second)
    [outcome] = client.outcomes()
    assert not outcome.done
    assert outcome.problem == "no answer after 16 tries"
    assert len(outcome.data) > 5000
    assert outcome.data == DATA[: len(outcome.data)]


@pytest.mark.parametrize("loss", [0.0, 0.2])
def test_a_vehicle_without_checksums_still_gives_files(loss: float) -> None:
    outcome = fetch(Watched(FtpRig(logs={"1.bin": DATA}), frozenset({FtpOpcode.CRC})), loss, verify=True)
    assert (outcome.done, outcome.checksum, outcome.data) == (True, None, DATA)


def test_a_file_that_is_not_there_is_named() -> None:
    outcome = fetch(Watched(FtpRig(logs={})))
    assert (outcome.done, outcome.error, outcome.problem) == (
        False,
        FtpError.NOT_FOUND,
        "no such file on the vehicle",
    )
