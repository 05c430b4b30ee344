"""MAVLink FTP of the ground station: whatever is lost, the file that arrives is the file."""

from __future__ import annotations

import random
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from dialects import messages as m
from link.core import Outgoing
from link.services.ftp.client import FtpClient
from link.services.ftp.job import MAX_SIZE, TRIES, FtpOutcome
from link.services.ftp.protocol import FtpError, FtpOpcode, FtpPacket, parse_packet
from tests.examples import examples
from tests.link.ftp_rig import FtpRig
from tests.link.services_world import Pair, from_vehicle, messages


def ending(client: FtpClient, pair: Pair, within: float = 120.0) -> FtpOutcome:
    outcomes: list[FtpOutcome] = []

    def ended() -> bool:
        outcomes.extend(client.outcomes())
        return bool(outcomes)

    pair.run_until(ended, within)
    [outcome] = outcomes
    return outcome


def fetch(vehicle: FtpRig, path: str, **how: Any) -> FtpOutcome:
    client = FtpClient(255, 190, target_system=1)
    pair = Pair(vehicle.server, client, **how)
    client.download(path, pair.now)
    return ending(client, pair)


@settings(max_examples=examples(25))
@given(
    st.integers(0, 10_000),
    st.sampled_from([0.0, 0.1, 0.3]),
    st.sampled_from([0, 1, 238, 239, 240, 478, 5000, 60_000]),
    st.booleans(),
)
def test_a_file_arrives_whatever_is_lost(seed: int, loss: float, size: int, slow: bool) -> None:
    data = random.Random(size).randbytes(size)
    vehicle = FtpRig(logs={"1.bin": data}, slow=slow)
    outcome = fetch(vehicle, "/logs/1.bin", loss=loss, seed=seed)
    assert outcome.done
    assert outcome.data == data


def test_a_megabyte_takes_what_the_link_gives() -> None:
    data = random.Random(1).randbytes(1_000_000)
    vehicle = FtpRig(logs={"1.bin": data}, rate=400_000.0)
    client = FtpClient(255, 190, target_system=1)
    pair = Pair(vehicle.server, client)
    client.download("/logs/1.bin", pair.now)
    took = pair.run_until(lambda: not client.busy, within=20.0)
    assert client.outcomes()[0].data == data
    assert took < 1.4 * 1_000_000 * 263 / 239 / 400_000
    assert pair.sent_by_client < 40


def test_a_file_that_is_not_there() -> None:
    outcome = fetch(FtpRig(), "/logs/3.bin")
    assert (outcome.done, outcome.error) == (False, FtpError.NOT_FOUND)


@pytest.mark.parametrize("loss", [0.0, 0.3])
def test_a_folder_is_listed(loss: float) -> None:
    vehicle = FtpRig(logs={f"{number:05}.bin": b"x" * number for number in range(100)})
    client = FtpClient(255, 190, target_system=1)
    pair = Pair(vehicle.server, client, loss=loss, seed=5)
    client.list_folder("/logs", pair.now)
    outcome = ending(client, pair)
    assert outcome.done
    assert [(entry.name, entry.size) for entry in outcome.entries] == [(f"{n:05}.bin", n) for n in range(100)]


def test_silence_ends_too() -> None:
    client = FtpClient(255, 190, target_system=1)
    client.download("/logs/1.bin", 0.0)
    sent = list(client.messages_to_send())
    for tenth in range(300):
        client.tick(tenth / 10)
        sent += client.messages_to_send()
    assert [(outcome.done, outcome.error) for outcome in client.outcomes()] == [(False, None)]
    assert len(sent) == TRIES
    assert len({parse_packet(message).sequence for message in messages(sent)}) == 1, "repeated, not asked anew"


def test_a_vehicle_that_falls_silent_in_the_middle_ends_too() -> None:
    vehicle = FtpRig(rate=10_000.0)
    client = FtpClient(255, 190, target_system=1)
    pair = Pair(vehicle.server, client)
    client.download("/logs/1.bin", pair.now)
    pair.run_until(lambda: client.progress[0] > 1000, within=5.0)
    for second in range(60):
        client.tick(pair.now + second)
    assert [outcome.done for outcome in client.outcomes()] == [False]


class Foreign:
    """A vehicle that only estimates the size, as ArduPilot does for its made files, and ends a burst by a NAK."""

    def __init__(self, data: bytes, announced: int) -> None:
        self.data, self.announced = data, announced

    def receive(self, received: Any, now: float) -> list[Any]:
        question = parse_packet(received.message)
        return [Outgoing(answer.message(255, 190)) for answer in self.answers(question)]

    def tick(self, now: float) -> list[Any]:
        return []

    def answers(self, question: FtpPacket) -> list[FtpPacket]:
        after, session = question.sequence + 1, question.session
        end = FtpPacket(after, FtpOpcode.NAK, session, bytes([FtpError.END_OF_FILE]), question.offset, question.op)
        if question.op == FtpOpcode.OPEN:
            size = self.announced.to_bytes(4, "little")
            return [FtpPacket(after, FtpOpcode.ACK, session, size, 0, FtpOpcode.OPEN)]
        if question.op == FtpOpcode.READ:
            data = self.data[question.offset : question.offset + (question.size or 0)]
            return [FtpPacket(after, FtpOpcode.ACK, session, data, question.offset, FtpOpcode.READ)] if data else [end]
        if question.op != FtpOpcode.BURST:
            return []
        pieces = [
            FtpPacket(after + number, FtpOpcode.ACK, session, self.data[at : at + 239], at, FtpOpcode.BURST)
            for number, at in enumerate(range(question.offset, len(self.data), 239))
        ]
        return [*pieces, end]


@pytest.mark.parametrize("loss", [0.0, 0.2])
@pytest.mark.parametrize("announced", [13_391, 14_820, 100_000, 1_048_576])
def test_a_size_that_was_only_estimated(announced: int, loss: float) -> None:
    data = random.Random(2).randbytes(13_391)
    client = FtpClient(255, 190, target_system=1)
    pair = Pair(Foreign(data, announced), client, loss=loss, seed=3)
    client.download("@PARAM/param.pck", pair.now)
    outcome = ending(client, pair)
    assert outcome.done
    assert outcome.data == data


def opened(size: bytes) -> FtpClient:
    """A client that has asked to open and got this answer."""
    client = FtpClient(255, 190, target_system=1)
    client.download("/x", 0.0)
    [question] = messages(client.messages_to_send())
    asked = parse_packet(question)
    answer = FtpPacket(asked.sequence + 1, FtpOpcode.ACK, asked.session, size, 0, FtpOpcode.OPEN)
    client.receive(from_vehicle(answer.message(255, 190)), 0.1)
    return client


def test_a_size_that_would_fill_our_memory_is_refused() -> None:
    client = opened((0xFFFF_FFFF).to_bytes(4, "little"))
    assert [outcome.done for outcome in client.outcomes()] == [False]
    assert opened(MAX_SIZE.to_bytes(4, "little")).outcomes() == []


@settings(max_examples=examples(200))
@given(st.lists(st.binary(min_size=251, max_size=251), max_size=10), st.integers(0, 2000))
def test_any_answer_raises_nothing_and_stays_in_bounds(payloads: list[bytes], size: int) -> None:
    client = opened(size.to_bytes(4, "little"))
    for number, payload in enumerate(payloads):
        client.receive(from_vehicle(m.FileTransferProtocol(0, 255, 190, payload)), 0.2 + number)
        client.tick(0.2 + number)
    for outcome in client.outcomes():
        assert len(outcome.data) <= size


def test_names_in_a_listing_are_fit_for_a_terminal() -> None:
    client = FtpClient(255, 190, target_system=1)
    client.list_folder("/", 0.0)
    asked = parse_packet(messages(client.messages_to_send())[0])
    lines = b"D\x1b[2J\0Fgood.bin\t12\0Fbad\tsize\0Sskipped\0"
    client.receive(
        from_vehicle(
            FtpPacket(asked.sequence + 1, FtpOpcode.ACK, asked.session, lines, 0, FtpOpcode.LIST).message(255, 190)
        ),
        0.1,
    )
    asked = parse_packet(messages(client.messages_to_send())[-1])
    assert asked.offset == 4
    end = FtpPacket(asked.sequence + 1, FtpOpcode.NAK, asked.session, bytes([FtpError.END_OF_FILE]), 4, FtpOpcode.LIST)
    client.receive(from_vehicle(end.message(255, 190)), 0.2)
    [outcome] = client.outcomes()
    assert [tuple(entry) for entry in outcome.entries] == [("\N{REPLACEMENT CHARACTER}[2J", None), ("good.bin", 12)]
