"""Operator sessions by themselves: proofs, their order and age, and who is remembered."""

from __future__ import annotations

import math

import pytest

from dialects.enums import OperatorFlag
from dialects.messages import RoverOperatorPresence
from link.core import Peer
from vehicle.drive.conversation import Conversation
from vehicle.drive.operator_session import (
    LINK_MEMORY,
    LINKS_MAX,
    PROOF_VALID,
    SENDERS_MAX,
    DemandOrder,
    DrivingSession,
    Proof,
    RecentProofs,
    echo_age,
    parse_proof,
)

WRAP = 2**32
PEER = Peer(0, "gcs")
SENDER = Conversation(255, 190, PEER, 1)
PROOF = Proof(session=7, clock=100, age=0.1)


def message(flags: int, echo: int = 1000) -> RoverOperatorPresence:
    return RoverOperatorPresence(1, 1, 500, echo, 7, 1, 0, flags)


def test_bounds() -> None:
    assert (PROOF_VALID, SENDERS_MAX, LINKS_MAX, LINK_MEMORY) == (1.0, 16, 8, 30.0)


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
        session = DrivingSession(7)
        assert session.clock is None
        assert session.order(PROOF._replace(clock=0)) is DemandOrder.NEWEST

    @pytest.mark.parametrize(
        ("before", "after", "newest"),
        [(100, 101, True), (100, 100, False), (100, 99, False), (WRAP - 1, 0, True), (0, WRAP - 1, False),
         (100, 100 + WRAP // 2 - 1, True), (100, 100 + WRAP // 2, False), (100, 100 + WRAP // 2 + 1, False)],
    )  # fmt: skip
    def test_later_demands_go_by_the_clock_of_the_sender(self, before: int, after: int, newest: bool) -> None:
        order = DrivingSession(7, clock=before).order(PROOF._replace(clock=after))
        assert order is (DemandOrder.NEWEST if newest else DemandOrder.NOT_NEWER)

    def test_a_conversation_is_proven_for_a_second(self) -> None:
        session = DrivingSession.begin(SENDER, PROOF, 10.0)
        assert session.is_proven(SENDER, 11.0)
        assert not session.is_proven(SENDER, 11.01)
        assert not session.is_proven(SENDER._replace(numbering=2), 10.0)

    def test_a_late_proof_proves_nothing_and_ends_nothing(self) -> None:
        session = DrivingSession.begin(SENDER, PROOF, 10.0)
        slow = SENDER._replace(peer=Peer(1, "slow"))
        session.add_proof(SENDER, PROOF._replace(age=3.0), 10.5, good=False)
        session.add_proof(slow, PROOF._replace(age=3.0), 10.5, good=False)
        assert session.is_proven(SENDER, 10.5)
        assert not session.is_proven(slow, 10.5)
        assert session.links[slow].age == 3.0
        session.add_proof(slow, PROOF, 10.6, good=True)
        assert session.is_proven(slow, 10.6)

    def test_age_of_a_setpoint_is_that_of_its_proof_plus_time_since(self) -> None:
        session = DrivingSession.begin(SENDER, PROOF, 10.0)
        assert session.setpoint_age(SENDER, 10.2) == pytest.approx(0.3)
        assert session.setpoint_age(SENDER._replace(numbering=2), 10.2) == math.inf

    def test_of_too_many_conversations_the_oldest_proof_is_forgotten(self) -> None:
        session = DrivingSession.begin(SENDER, PROOF, 10.0)
        for number in range(1, LINKS_MAX + 5):
            session.add_proof(SENDER._replace(numbering=number), PROOF, 5.0, good=number % 2 == 0)
        assert len(session.links) == LINKS_MAX
        assert SENDER in session.links


class TestRecentProofs:
    def test_a_session_begins_with_all_its_links_and_no_other(self) -> None:
        proofs = RecentProofs()
        others = [SENDER._replace(numbering=100 + number) for number in range(SENDERS_MAX - 3)]
        proofs.add(SENDER, PROOF, 10.0)
        proofs.add(SENDER._replace(component=1), PROOF, 10.0)
        proofs.add(SENDER._replace(numbering=99), PROOF._replace(session=PROOF.session + 1), 10.0)
        for other in others:
            proofs.add(other, PROOF, 10.5)
        session = proofs.session_of(SENDER, 11.0)
        assert session is not None
        assert list(session.links) == [SENDER, *others[: LINKS_MAX - 1]]
        assert session.is_proven(others[0], 11.5)

    def test_a_proof_names_the_session_for_one_second(self) -> None:
        proofs = RecentProofs()
        proofs.add(SENDER, PROOF, 10.0)
        assert proofs.session_of(SENDER, 11.0) == DrivingSession.begin(SENDER, PROOF, 10.0)
        assert proofs.session_of(SENDER, 11.01) is None

    def test_without_a_proof_there_is_none(self) -> None:
        proofs = RecentProofs()
        assert proofs.session_of(SENDER, 0.0) is None
        proofs.add(SENDER, PROOF, 10.0)
        assert proofs.session_of(SENDER._replace(component=1), 10.0) is None

    def test_the_newest_of_a_sender_counts(self) -> None:
        proofs = RecentProofs()
        proofs.add(SENDER, PROOF, 10.0)
        proofs.add(SENDER, PROOF._replace(session=8), 10.5)
        assert proofs.session_of(SENDER, 11.2) == DrivingSession.begin(SENDER, PROOF._replace(session=8), 10.5)

    def test_of_too_many_the_oldest_is_forgotten(self) -> None:
        proofs = RecentProofs()
        senders = [SENDER._replace(component=number) for number in range(SENDERS_MAX + 1)]
        for sender in senders[:SENDERS_MAX]:
            proofs.add(sender, PROOF, 10.0)
        proofs.add(senders[0], PROOF, 10.1)  # now the newest
        assert all(proofs.session_of(sender, 10.2) for sender in senders[:SENDERS_MAX])
        proofs.add(senders[-1], PROOF, 10.2)
        assert [sender.component for sender in senders if not proofs.session_of(sender, 10.3)] == [1]

    def test_links_of_one_session_are_known_for_half_a_minute(self) -> None:
        proofs, other = RecentProofs(), SENDER._replace(peer=Peer(1, "gcs"))
        assert proofs.links_of(SENDER, 10.0) == []
        for sender, session in (
            (SENDER, 7), (other, 7), (SENDER._replace(component=1), 7), (SENDER._replace(numbering=2), 8),
        ):  # fmt: skip
            proofs.add(sender, PROOF._replace(session=session), 10.0)
        assert proofs.links_of(SENDER, 10.0) == [other]
        proofs.add(SENDER, PROOF, 20.0)
        assert proofs.links_of(SENDER, 10.0 + LINK_MEMORY) == [other]
        assert proofs.links_of(SENDER, 10.1 + LINK_MEMORY) == []
        assert proofs.links_of(other, 10.1 + LINK_MEMORY) == []
