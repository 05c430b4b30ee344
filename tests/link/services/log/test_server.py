"""The log protocol: a list, the bytes of a log, and who wants all of them erased."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from dialects import messages as m
from link.services.ftp.files import MemoryFolder
from link.services.log.server import DATA_SIZE, MAX_CLIENTS, MAX_REQUESTS, LogServer
from link.services.pacing import BulkPacer
from tests.link.ftp_rig import SlowFolder
from tests.link.services_world import OTHER_PEER, PEER, from_gcs, messages

LOG = bytes(range(250)) * 4


@dataclass
class FtpRig:
    """A server, and what it said."""

    files: dict[str, bytes] = field(default_factory=lambda: {"0.bin": LOG, "1.bin": b"", "2.bin": bytes(180)})
    rate: float = 1e6
    slow: bool = False
    erasers: list[int] = field(default_factory=list)

    def __post_init__(self) -> None:
        self.server = LogServer(
            SlowFolder(self.files) if self.slow else MemoryFolder(self.files),
            system=1,
            component=1,
            pacer=BulkPacer(lambda peer: self.rate),
            when=lambda name: 1_700_000_000,
            erase=lambda received, now: self.erasers.append(received.system),
        )

    def ask(self, message: m.Message, now: float = 0.0, ticks: int = 100, **who: Any) -> list[Any]:
        """All that is said to it within `ticks` of 20 ms."""
        outgoing = self.server.receive(from_gcs(message, **who), now)
        for step in range(ticks):
            outgoing += self.server.tick(now + step * 0.02)
        return messages(outgoing)


def content(answers: list[Any]) -> bytes:
    return b"".join(bytes(each.data[: each.count]) for each in answers)


def test_the_list_names_every_log() -> None:
    entries = FtpRig().ask(m.LogRequestList(1, 1, 0, 0xFFFF))
    assert [(entry.id, entry.size) for entry in entries] == [(0, 1000), (1, 0), (2, 180)]
    assert {(entry.num_logs, entry.last_log_num, entry.time_utc) for entry in entries} == {(3, 2, 1_700_000_000)}


@pytest.mark.parametrize(("start", "end", "numbers"), [(1, 1, [1]), (1, 9, [1, 2]), (5, 9, []), (2, 1, [])])
def test_a_part_of_the_list(start: int, end: int, numbers: list[int]) -> None:
    assert [entry.id for entry in FtpRig().ask(m.LogRequestList(1, 1, start, end))] == numbers


def test_no_logs_is_said_and_not_silence() -> None:
    [entry] = FtpRig(files={}).ask(m.LogRequestList(1, 1, 0, 0xFFFF))
    assert (entry.num_logs, entry.id, entry.size) == (0, 0, 0)


@pytest.mark.parametrize("slow", [False, True])
def test_a_log_comes_whole_and_in_order(slow: bool) -> None:
    answers = FtpRig(slow=slow).ask(m.LogRequestData(1, 1, 0, 0, 0xFFFF_FFFF))
    assert content(answers) == LOG
    assert [answer.ofs for answer in answers] == list(range(0, 1000, DATA_SIZE))
    assert answers[-1].count == 1000 % DATA_SIZE


def test_a_log_of_full_pieces_ends_with_an_empty_one() -> None:
    assert [answer.count for answer in FtpRig().ask(m.LogRequestData(1, 1, 2, 0, 0xFFFF_FFFF))] == [90, 90, 0]


def test_a_part_of_a_log() -> None:
    answers = FtpRig().ask(m.LogRequestData(1, 1, 0, 100, 200))
    assert content(answers) == LOG[100:300]


@pytest.mark.parametrize(("log", "offset"), [(0, 1000), (0, 0xFFFF_FFFF), (1, 0), (3, 0), (0xFFFF, 0)])
def test_where_there_is_nothing_an_empty_piece_says_so(log: int, offset: int) -> None:
    [answer] = FtpRig().ask(m.LogRequestData(1, 1, log, offset, 90))
    assert (answer.id, answer.ofs, answer.count) == (log, offset, 0)


def test_holes_are_filled_in_turn_and_one_asked_twice_once() -> None:
    vehicle = FtpRig()
    for offset in (180, 0, 180):
        vehicle.server.receive(from_gcs(m.LogRequestData(1, 1, 0, offset, 90)), 0.0)
    assert [answer.ofs for answer in vehicle.ask(m.LogRequestData(1, 1, 0, 900, 90))] == [180, 0, 900]


def test_wishes_and_clients_are_bounded() -> None:
    vehicle = FtpRig(rate=1.0)
    for number in range(1000):
        for offset in range(20):
            peer = PEER._replace(address=number)
            vehicle.server.receive(from_gcs(m.LogRequestData(1, 1, 0, offset, 1), peer=peer), 0.0)
    vehicle.rate = 1e6
    answers = [answer for step in range(200) for answer in messages(vehicle.server.tick(10.0 + step * 0.02))]
    assert len(answers) <= MAX_CLIENTS * MAX_REQUESTS


def test_a_log_is_paced_by_the_link_and_stops_when_asked() -> None:
    vehicle = FtpRig(files={"0.bin": bytes(100_000)}, rate=2000.0)
    sent = vehicle.ask(m.LogRequestData(1, 1, 0, 0, 0xFFFF_FFFF), ticks=50)
    assert 1700 <= len(sent) * 109 <= 2300
    assert vehicle.ask(m.LogRequestEnd(1, 1), now=2.0) == []


def test_two_peers_do_not_mix() -> None:
    vehicle = FtpRig()
    vehicle.server.receive(from_gcs(m.LogRequestData(1, 1, 0, 0, 90)), 0.0)
    vehicle.server.receive(from_gcs(m.LogRequestData(1, 1, 2, 0, 90), peer=OTHER_PEER), 0.0)
    sent = vehicle.server.tick(0.1)
    assert [each.peer for each in sent] == [PEER, OTHER_PEER]
    assert [message.id for message in messages(sent)] == [0, 2]


def test_who_wants_to_erase_all_is_told_on() -> None:
    vehicle = FtpRig()
    assert vehicle.ask(m.LogErase(1, 1)) == []
    assert vehicle.ask(m.LogErase(2, 1)) == []
    assert vehicle.erasers == [255]
    assert len(vehicle.files) == 3


def test_numbers_mean_what_they_meant_in_the_list() -> None:
    """The oldest log goes and a new one comes while somebody downloads."""
    vehicle = FtpRig()
    assert len(vehicle.ask(m.LogRequestList(1, 1, 0, 0xFFFF))) == 3
    del vehicle.files["0.bin"]
    vehicle.files["3.bin"] = bytes(10)
    assert content(vehicle.ask(m.LogRequestData(1, 1, 2, 0, 0xFFFF_FFFF))) == bytes(180)
    assert content(vehicle.ask(m.LogRequestData(1, 1, 0, 0, 0xFFFF_FFFF))) == b""
    assert [each.size for each in vehicle.ask(m.LogRequestList(1, 1, 1, 1))] == [0]
    assert [each.size for each in vehicle.ask(m.LogRequestList(1, 1, 0, 1))] == [0, 180]
    assert content(vehicle.ask(m.LogRequestData(1, 1, 2, 0, 0xFFFF_FFFF))) == bytes(10)


def test_many_clients_may_come_one_after_the_other() -> None:
    vehicle = FtpRig()
    for number in range(MAX_CLIENTS * 3):
        peer = PEER._replace(address=number)
        assert len(vehicle.ask(m.LogRequestList(1, 1, 0, 0xFFFF), peer=peer)) == 3


@pytest.mark.parametrize(
    ("system", "component", "introduced"), [(2, 1, True), (0, 0, True), (1, 9, True), (1, 1, False)]
)
def test_what_is_for_others_or_from_strangers_is_not_answered(system: int, component: int, introduced: bool) -> None:
    assert FtpRig().ask(m.LogRequestList(system, component, 0, 0xFFFF), introduced=introduced) == []
    assert FtpRig().ask(m.LogRequestData(system, component, 0, 0, 90), introduced=introduced) == []


@given(
    st.lists(
        st.tuples(*[st.integers(0, 0xFFFF)] * 2, st.integers(0, 0xFFFF_FFFF), st.integers(0, 0xFFFF_FFFF)), max_size=9
    )
)
def test_nothing_that_is_asked_raises(questions: list[tuple[int, int, int, int]]) -> None:
    vehicle = FtpRig()
    for log, end, offset, count in questions:
        vehicle.ask(m.LogRequestData(1, 1, log % 4, offset, count), ticks=3)
        vehicle.ask(m.LogRequestList(1, 1, log, end), ticks=3)
