"""Time, ping and the services that are not offered: every question has an answer."""

from __future__ import annotations

import pytest

from dialects import messages as m
from tests.vehicle.bench import DRIVER, Bench


def test_time_and_ping_are_echoed() -> None:
    bench = Bench()
    bench.say(m.Timesync(tc1=0, ts1=123))
    assert bench.newest(m.Timesync).ts1 == 123
    assert bench.newest(m.Timesync).tc1 > 0
    bench.say(m.Ping(1, 7, 0, 0))
    assert (bench.newest(m.Ping).seq, bench.newest(m.Ping).target_system) == (7, DRIVER)


@pytest.mark.parametrize("kind", [0, 1, 2])
def test_there_are_no_plans(kind: int) -> None:
    bench = Bench()
    bench.say(m.MissionRequestList(1, 1, kind))
    answer = bench.newest(m.MissionCount)
    assert (answer.target_system, answer.count, answer.mission_type) == (DRIVER, 0, kind)


def test_there_are_no_logs() -> None:
    bench = Bench()
    bench.say(m.LogRequestList(1, 1, 0, 0xFFFF))
    assert bench.newest(m.LogEntry).num_logs == 0


@pytest.mark.parametrize(
    ("opcode", "answer", "fault"), [(4, 129, 10), (3, 129, 7), (200, 129, 7), (1, 128, None), (2, 128, None)]
)
def test_there_are_no_files(opcode: int, answer: int, fault: int | None) -> None:
    bench = Bench()
    payload = [0xFF, 0xFF, 5, opcode] + [255] * 247
    bench.say(m.FileTransferProtocol(0, 1, 1, payload))
    reply = bench.newest(m.FileTransferProtocol)
    assert (reply.target_system, len(reply.payload)) == (DRIVER, 251)
    assert reply.payload[:4] == [0, 0, 5, answer]  # the sequence number goes on, and round
    assert reply.payload[5] == opcode
    assert (reply.payload[4], reply.payload[12]) == ((1, fault) if fault else (0, 0))


def test_for_another_system_there_is_silence() -> None:
    bench = Bench()
    bench.wait(0.5)
    count = len(bench.sent)
    bench.say(m.MissionRequestList(2, 1, 0))
    bench.say(m.LogRequestList(1, 9, 0, 0xFFFF))
    bench.say(m.Ping(1, 7, 1, 1))
    assert len(bench.sent) == count
