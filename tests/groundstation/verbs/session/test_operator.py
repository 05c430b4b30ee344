"""The proofs of a verb's session: several at first, and again before a command that comes later."""

from __future__ import annotations

import pytest

from dialects import messages as m
from groundstation.station.driving.proofs import SessionProofs
from groundstation.verbs.session.operator import PROOFS_FIRST, PROVEN_FOR, VerbOperator
from groundstation.verbs.session.outbox import VerbOutbox
from link.core import Peer, Received
from tests.fakes.lone_verb import heard_contact
from vehicle.drive.operator_session import PROOF_VALID

STEP = 0.01


class Proving:
    """A verb whose vehicle has our dialect and sends its time four times a second."""

    def __init__(self) -> None:
        self.now = 10.0
        contact, self.outbox = heard_contact(self.now), VerbOutbox()
        self.state = contact.state
        self.operator = VerbOperator(contact, SessionProofs(7), self.outbox.demands)
        self.operator.begin(self.now)

    def wait(self, seconds: float) -> int:
        """Let time pass; return the number of proofs that were sent."""
        proofs = 0
        for _ in range(round(seconds / STEP)):
            self.now += STEP
            if round(self.now / STEP) % 25 == 0:
                self._hear(m.RoverDriveStatus(round(self.now * 1000), 0, 0, 0, [0] * 4, 0, 0, 0))
            self.operator.tick(self.now)
            sent = [each.message for each in self.outbox.pop()]
            proofs += sum(isinstance(each, m.RoverOperatorPresence) for each in sent)
        return proofs

    def _hear(self, message: m.Message) -> None:
        self.state.receive(Received(message, 1, 1, 0, Peer(0, "vehicle"), True), self.now)


@pytest.fixture
def proving() -> Proving:
    made = Proving()
    made.wait(0.5)
    assert made.operator.proven
    return made


def test_single_proofs_follow_the_first_ones(proving: Proving) -> None:
    assert proving.wait(2.0) <= 9


def test_a_later_command_is_proven_as_well_as_the_first(proving: Proving) -> None:
    proving.wait(PROOF_VALID + 0.3)
    proving.operator.prove_again(proving.now)
    assert not proving.operator.proven
    assert proving.wait(0.4) >= PROOFS_FIRST
    assert proving.operator.proven


def test_a_command_at_once_needs_no_other_proofs() -> None:
    made = Proving()
    while not made.operator.proven:
        made.wait(STEP)
    made.wait(PROVEN_FOR - 2 * STEP)
    made.operator.prove_again(made.now)
    assert made.operator.proven


def test_another_verb_that_proves_the_session_is_left_alone(proving: Proving) -> None:
    proving.operator.may_prove = lambda _: False
    proving.wait(1.0)
    proving.operator.prove_again(proving.now)
    assert proving.operator.proven
