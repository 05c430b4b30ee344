"""The log protocol of the ground station: whatever is lost, the log that arrives is the log."""

from __future__ import annotations

import random

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from dialects import messages as m
from link.services.ftp.files import MemoryFolder
from link.services.log.client import DATA_SIZE, MAX_LOGS, TRIES, LogClient, LogOutcome, RemoteLog
from link.services.log.server import LogServer
from link.services.pacing import BulkPacer
from tests.link.services_world import Pair, from_vehicle
from tests.rows import each_row


def server(files: dict[str, bytes], rate: float = 1e6) -> LogServer:
    pacer = BulkPacer(lambda peer: rate)
    return LogServer(MemoryFolder(files), system=1, component=1, pacer=pacer, when=lambda name: 1_700_000_000)


def ending(client: LogClient, pair: Pair) -> LogOutcome:
    pair.run_until(lambda: not client.busy, 200.0)
    [outcome] = client.outcomes()
    return outcome


@settings(max_examples=25)
@given(
    st.integers(0, 10_000),
    st.sampled_from([0.0, 0.1, 0.3]),
    st.sampled_from([0, 1, 89, 90, 91, 180, 5000, 20_000]),
)
def test_a_log_arrives_whatever_is_lost(seed: int, loss: float, size: int) -> None:
    data = random.Random(size).randbytes(size)
    client = LogClient(255, 190, target_system=1)
    pair = Pair(server({"1.bin": b"other", "2.bin": data}), client, loss=loss, seed=seed)
    client.list_logs(pair.now)
    listed = ending(client, pair)
    assert [(log.number, log.size) for log in listed.logs] == [(0, 5), (1, size)]
    client.download(listed.logs[1], pair.now)
    outcome = ending(client, pair)
    assert outcome.done
    assert outcome.data == data


@pytest.mark.parametrize("loss", [0.0, 0.3])
def test_a_long_list(loss: float) -> None:
    client = LogClient(255, 190, target_system=1)
    pair = Pair(server({f"{number:03}.bin": b"x" * number for number in range(150)}), client, loss=loss, seed=4)
    client.list_logs(pair.now)
    assert [log.size for log in ending(client, pair).logs] == list(range(150))


def test_no_logs() -> None:
    client = LogClient(255, 190, target_system=1)
    pair = Pair(server({}), client)
    client.list_logs(pair.now)
    assert ending(client, pair) == LogOutcome(None, True, (), tries=1)


def test_a_download_is_resumed_at_its_last_whole_piece() -> None:
    data = random.Random(1).randbytes(9_000)
    client = LogClient(255, 190, target_system=1)
    client.download(RemoteLog(0, 0, len(data)), 0.0, data[:1000])
    [outgoing] = client.messages_to_send()
    assert isinstance(outgoing.message, m.LogRequestData)
    assert (outgoing.message.ofs, outgoing.message.count) == (900, 8_100)
    pair = Pair(server({"1.bin": data}), client)
    assert ending(client, pair).data == data


@each_row("size", [89, 90, 1000, 8_999, 9_000, 20_000])
@each_row("loss", [0.0, 0.3])
def test_what_was_left_of_another_log_is_not_used(size: int, loss: float) -> None:
    data, other = random.Random(1).randbytes(9_000), random.Random(2).randbytes(size)
    client = LogClient(255, 190, target_system=1)
    pair = Pair(server({"1.bin": data}), client, loss=loss, seed=3)
    client.download(RemoteLog(0, 0, len(data)), pair.now, other)
    assert ending(client, pair).data == data


def test_a_log_that_turns_out_shorter() -> None:
    data = random.Random(1).randbytes(1000)
    client = LogClient(255, 190, target_system=1)
    pair = Pair(server({"1.bin": data}), client)
    client.download(RemoteLog(0, 0, 5000), pair.now)
    outcome = ending(client, pair)
    assert (outcome.done, outcome.data) == (True, data)


def test_silence_ends_it_and_keeps_the_beginning() -> None:
    data = random.Random(1).randbytes(50_000)
    client = LogClient(255, 190, target_system=1)
    pair = Pair(server({"1.bin": data}, rate=20_000.0), client)
    client.download(RemoteLog(0, 0, len(data)), pair.now)
    pair.run_until(lambda: client.progress[0] > 10_000, within=5.0)
    for second in range(60):
        client.tick(pair.now + second)
    [outcome] = client.outcomes()
    assert (outcome.done, outcome.tries) == (False, TRIES)
    assert len(outcome.data) > 10_000
    assert outcome.data == data[: len(outcome.data)]


@given(st.integers(0, 65535), st.integers(0, 2**32 - 1), st.integers(0, 255), st.integers(0, 65535))
def test_no_message_raises_or_grows_without_bound(number: int, offset: int, count: int, total: int) -> None:
    client = LogClient(255, 190, target_system=1)
    client.download(RemoteLog(0, 0, 1000), 0.0)
    client.receive(from_vehicle(m.LogData(0, offset, count, [7] * DATA_SIZE)), 0.1)
    assert client.progress[0] <= 1000
    client.list_logs(0.2)
    client.receive(from_vehicle(m.LogEntry(number, total, total, 0, 5)), 0.3)
    assert client.progress[0] <= MAX_LOGS
