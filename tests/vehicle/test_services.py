"""Parameters, time, ping and the services that are not offered: every question has an answer."""

from __future__ import annotations

import pytest

from dialects import messages as m
from dialects.enums import ParamFault
from link.core import Peer
from tests.vehicle.bench import DRIVER, OTHER, Bench, said
from vehicle.params import TABLE

NAMES = [parameter.name for parameter in TABLE]


def read(bench: Bench, name: bytes, index: int = -1) -> m.Message:
    bench.say(m.ParamRequestRead(1, 1, name, index))
    return bench.newest(m.Message)


def test_the_list_is_complete_in_order_and_paced() -> None:
    bench = Bench()
    bench.say(m.ParamRequestList(1, 1))
    bench.wait(0.1)
    assert 1 <= len(bench.all(m.ParamValue)) <= 6
    bench.wait(1.0)
    values = bench.all(m.ParamValue)
    assert [value.param_id for value in values] == NAMES
    assert [value.param_index for value in values] == list(range(len(TABLE)))
    assert {(value.param_type, value.param_count) for value in values} == {(9, len(TABLE))}


def test_63_asking_again_and_again_is_one_run_for_each_peer() -> None:
    bench = Bench()
    for _ in range(10):
        bench.say(m.ParamRequestList(1, 1))
        bench.say(m.ParamRequestList(1, 0), OTHER)
        bench.wait(0.02)
    bench.wait(1.0)
    to = [peer for message, peer in zip(bench.sent, bench.peers, strict=True) if isinstance(message, m.ParamValue)]
    assert to.count(Peer(0, f"gcs {DRIVER}")) == to.count(Peer(0, f"gcs {OTHER}")) == len(TABLE)


def test_many_peers_have_no_more_runs_than_a_link_has_peers() -> None:
    bench = Bench()
    for number in range(50):
        bench.say(m.ParamRequestList(1, 1), address=f"peer {number}")
    bench.wait(2.0)
    assert len(bench.all(m.ParamValue)) == 8 * len(TABLE)


def test_read_by_name_and_by_index() -> None:
    bench = Bench()
    for answer in (read(bench, b"MAN_TIMEOUT"), read(bench, b"", NAMES.index("MAN_TIMEOUT"))):
        assert isinstance(answer, m.ParamValue)
        assert answer.param_id == "MAN_TIMEOUT"
        assert answer.param_value == pytest.approx(0.45)


@pytest.mark.parametrize(
    ("name", "index"), [(b"NO_SUCH", -1), (b"", 9999), (b"", -2), (b"\xff" * 16, -1), (b"", 32767)]
)
def test_62_what_is_not_there_is_an_error_and_no_value(name: bytes, index: int) -> None:
    answer = read(Bench(), name, index)
    assert isinstance(answer, m.ParamError)
    assert answer.error == ParamFault.DOES_NOT_EXIST


def test_60_setting_is_refused_with_the_value_that_stays() -> None:
    bench = Bench()
    bench.say(m.ParamSet(1, 1, b"MAN_TIMEOUT", 2.0, 9))
    assert bench.newest(m.ParamValue).param_value == pytest.approx(0.45)
    assert bench.newest(m.ParamError).error == ParamFault.READ_ONLY
    bench.say(m.ParamSet(1, 1, b"NO_SUCH", 2.0, 9))
    bench.wait(0.1)
    assert bench.newest(m.ParamError).error == ParamFault.DOES_NOT_EXIST
    assert said(bench, "No parameter NO_SUCH")


def test_strangers_and_other_targets_get_nothing() -> None:
    bench = Bench()
    bench.say(m.ParamRequestList(1, 1), introduced=False)
    bench.say(m.ParamRequestList(2, 1))
    bench.say(m.ParamRequestList(1, 42))
    bench.wait(1.0)
    assert not bench.all(m.ParamValue)


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
