"""Operator sessions by themselves: proofs, their order and age, and who is remembered."""

from __future__ import annotations

import math

import pytest

from dialects.enums import OperatorFlag
from dialects.messages import RoverOperatorPresence
from link.core import Peer, Received
from vehicle.drive.operator_session import (
    PROOF_VALID,
    SOURCES_MAX,
    SUCCESSION_TIME,
    DemandOrder,
    DrivingSession,
    Proof,
    RecentProofs,
    Source,
    echo_age,
    parse_proof,
)

WRAP = 2**32
PEER = Peer(0, "gcs")
SOURCE = Source(255, 190, PEER)
PROOF = Proof(session=7, clock=100, age=0.1)


def message(flags: int, echo: int = 1000) -> RoverOperatorPresence:
    return RoverOperatorPresence(1, 1, 500, echo, 7, 1, 0, flags)


def test_bounds() -> None:
    assert (SUCCESSION_TIME, PROOF_VALID, SOURCES_MAX) == (0.7, 1.0, 16)


def test_the_source_is_system_component_and_peer() -> None:
    assert Source.of(Received(message(0), 255, 190, 3, PEER, introduced=True)) == SOURCE


def test_only_a_message_with_axes_is_a_proof() -> None:
    assert parse_proof(message(int(OperatorFlag.AXES)), 1.5) == Proof(7, 500, 0.5)
    assert parse_proof(message(int(~OperatorFlag.AXES) & 0xFF), 1.5) is None
    assert parse_proof(message(0), 1.5) is None


@pytest.mark.parametrize(
    ("echo", "since_boot", "age"),
    [(0, 50.0, math.inf), (1, 50.0, 49.999), (50_000, 50.0, 0.0), (50_001, 50.0, WRAP / 1000 - 0.001),
     (WRAP - 500, WRAP / 1000 + 0.5, 1.0)],
)  # fmt: skip
def test_the_age_of_an_echo(echo: int, since_boot: float, age: float) -> None:
    assert echo_age(echo, since_boot) == pytest.approx(age)


class TestSession:
    def test_its_first_demand_is_the_newest(self) -> None:
        session = DrivingSession(7, 10.0)
        assert session.clock is None
        assert session.order(PROOF._replace(clock=0)) is DemandOrder.NEWEST

    @pytest.mark.parametrize(
        ("before", "after", "newest"),
        [(100, 101, True), (100, 100, False), (100, 99, False), (WRAP - 1, 0, True), (0, WRAP - 1, False),
         (100, 100 + WRAP // 2 - 1, True), (100, 100 + WRAP // 2, False), (100, 100 + WRAP // 2 + 1, False)],
    )  # fmt: skip
    def test_later_demands_go_by_the_clock_of_the_sender(self, before: int, after: int, newest: bool) -> None:
        order = DrivingSession(7, 10.0, clock=before).order(PROOF._replace(clock=after))
        assert order is (DemandOrder.NEWEST if newest else DemandOrder.NOT_NEWER)

    def test_it_may_be_succeeded_after_its_time_without_a_proof(self) -> None:
        session = DrivingSession(7, 0.0)
        assert not session.may_be_succeeded(SUCCESSION_TIME)
        assert session.may_be_succeeded(SUCCESSION_TIME + 0.001)
        assert not DrivingSession(7, 10.0).may_be_succeeded(10.6)


class TestRecentProofs:
    def test_a_proof_names_the_session_for_one_second(self) -> None:
        proofs = RecentProofs()
        proofs.add(SOURCE, PROOF, 10.0)
        assert proofs.session_of(SOURCE, 11.0) == DrivingSession(7, 10.0)
        assert proofs.session_of(SOURCE, 11.01) is None

    def test_without_a_proof_there_is_none(self) -> None:
        proofs = RecentProofs()
        assert proofs.session_of(None, 0.0) is None
        assert proofs.session_of(SOURCE, 0.0) is None
        proofs.add(SOURCE, PROOF, 10.0)
        assert proofs.session_of(None, 10.0) is None
        assert proofs.session_of(SOURCE._replace(component=1), 10.0) is None

    def test_the_newest_of_a_source_counts(self) -> None:
        proofs = RecentProofs()
        proofs.add(SOURCE, PROOF, 10.0)
        proofs.add(SOURCE, PROOF._replace(session=8), 10.5)
        assert proofs.session_of(SOURCE, 11.2) == DrivingSession(8, 10.5)

    def test_of_too_many_the_oldest_is_forgotten(self) -> None:
        proofs = RecentProofs()
        sources = [SOURCE._replace(component=number) for number in range(SOURCES_MAX + 1)]
        for source in sources[:SOURCES_MAX]:
            proofs.add(source, PROOF, 10.0)
        proofs.add(sources[0], PROOF, 10.1)  # now the newest
        assert all(proofs.session_of(source, 10.2) for source in sources[:SOURCES_MAX])
        proofs.add(sources[-1], PROOF, 10.2)
        assert [source.component for source in sources if not proofs.session_of(source, 10.3)] == [1]
