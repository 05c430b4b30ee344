"""Uploads: whatever is lost, the file on the vehicle is the file, or the operator is told why not."""

from __future__ import annotations

import random
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from link.services.ftp.client import FtpClient
from link.services.ftp.job import MAX_SIZE, TRIES, FtpOperation, FtpOutcome
from link.services.ftp.protocol import FtpError, FtpOpcode, crc32, parse_packet
from link.services.ftp.upload import DIFFERS
from tests.link.ftp_rig import FtpRig
from tests.link.services_world import Pair


def send(server: Any, path: str, data: bytes, loss: float = 0.0, seed: int = 0) -> FtpOutcome:
    client = FtpClient(255, 190, target_system=1)
    pair = Pair(server, client, loss=loss, seed=seed)
    client.upload(path, data, pair.now)
    pair.run_until(lambda: not client.busy, 120.0)
    [outcome] = client.outcomes()
    assert outcome.job is FtpOperation.UPLOAD
    return outcome


@settings(max_examples=25)
@given(st.integers(0, 10_000), st.sampled_from([0.0, 0.2]), st.sampled_from([1, 239, 240, 5000]))
def test_a_file_arrives_whatever_is_lost(seed: int, loss: float, size: int) -> None:
    data = b"{" + random.Random(size).randbytes(size - 1)
    vehicle = FtpRig()
    outcome = send(vehicle.server, "/missions/new.plan", data, loss, seed)
    assert outcome.done, outcome
    assert outcome.checksum == crc32(data)
    assert vehicle.written == [("new.plan", data)]


@pytest.mark.parametrize(
    ("path", "data", "error", "words"),
    [
        ("/logs/x.bin", b"{x", FtpError.PROTECTED, "the vehicle protects the file"),
        ("/missions/x.exe", b"{x", FtpError.PROTECTED, "the vehicle protects the file"),
        ("/missions/x.plan", b"bad", FtpError.FAIL, "the vehicle reports a failure"),
        ("/nowhere/x.plan", b"{", FtpError.NOT_FOUND, "no such file on the vehicle"),
        ("/" + "x" * 300, b"{", None, "the path is empty or too long"),
    ],
)
def test_a_refusal_is_named(path: str, data: bytes, error: int | None, words: str) -> None:
    vehicle = FtpRig()
    outcome = send(vehicle.server, path, data)
    assert (outcome.done, outcome.error, outcome.problem) == (False, error, words)
    assert vehicle.written == []


def test_too_many_bytes_are_refused() -> None:  # no parameter of the test above: pytest would print all of them
    vehicle = FtpRig()
    outcome = send(vehicle.server, "/missions/x.plan", bytes(MAX_SIZE + 1))
    assert (outcome.done, outcome.problem) == (False, f"{MAX_SIZE + 1} bytes are more than {MAX_SIZE}")
    assert vehicle.written == []


class Part:
    """A vehicle that does not answer some requests, or computes another checksum."""

    def __init__(self, silent: frozenset[FtpOpcode] = frozenset(), damage: bool = False) -> None:
        self.vehicle, self.silent, self.damage = FtpRig(), silent, damage

    def receive(self, received: Any, now: float) -> list[Any]:
        packet = parse_packet(received.message)
        if packet.op in self.silent:
            return []
        answers = self.vehicle.server.receive(received, now)
        if packet.op == FtpOpcode.TERMINATE and self.damage:
            self.vehicle.missions.files["a.plan"] = b"{other"
        return answers

    def tick(self, now: float) -> list[Any]:
        return self.vehicle.server.tick(now)


@pytest.mark.parametrize("op", [FtpOpcode.CREATE, FtpOpcode.WRITE, FtpOpcode.TERMINATE])
def test_a_vehicle_that_falls_silent_ends_it(op: FtpOpcode) -> None:
    outcome = send(Part(frozenset({op})), "/missions/a.plan", b"{" * 600)
    assert (outcome.done, outcome.problem) == (False, f"no answer after {TRIES} tries")


def test_a_vehicle_without_checksums_has_the_file() -> None:
    outcome = send(Part(frozenset({FtpOpcode.CRC})), "/missions/a.plan", b"{")
    assert (outcome.done, outcome.checksum) == (True, None)


def test_a_file_that_arrived_damaged_is_noticed() -> None:
    outcome = send(Part(damage=True), "/missions/a.plan", b"{good")
    assert (outcome.done, outcome.problem) == (False, DIFFERS)
