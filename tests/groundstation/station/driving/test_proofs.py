"""The proofs of one session: one clock for all that operates in its name."""

from __future__ import annotations

from dialects import messages as m
from dialects.enums import OperatorFlag
from groundstation.input.style import Style
from groundstation.station.driving.operator import OperatorSession
from groundstation.station.driving.proofs import OLDEST_AGE, SessionProofs
from groundstation.verbs.session.operator import VerbOperator
from tests.fakes.lone_verb import heard_contact

DEMAND = m.ManualControl(1, 600, m.INVALID_AXIS, m.INVALID_AXIS, -50, 0)


def test_screen_and_verb_prove_one_session_by_one_clock() -> None:
    proofs, contact = SessionProofs(7), heard_contact(4.0)
    state = contact.state
    screen, verb = OperatorSession(Style.HOLD, 0.6), VerbOperator(contact, proofs, [])
    made = [proofs.build(state, each, 5.0) for each in (screen, verb, screen)]
    assert [each.time_boot_ms for each in made] == [5000, 5001, 5002]
    assert {each.session_id for each in made} == {7}
    assert [bool(each.flags & OperatorFlag.SCRIPT) for each in made] == [False, True, False]
    assert proofs.build(state, verb, 6.0, DEMAND).x == 600
    assert proofs.build(state, verb, 6.1).r == m.INVALID_AXIS


def test_a_proof_says_how_old_the_last_input_is() -> None:
    proofs, contact = SessionProofs(7), heard_contact(4.0)
    state, verb = contact.state, VerbOperator(contact, proofs, [])
    assert proofs.build(state, verb, 5.0).last_input_age_ms == OLDEST_AGE
    verb.begin(5.0)
    assert proofs.build(state, verb, 5.25).last_input_age_ms == 250
    assert proofs.build(state, verb, 500.0).last_input_age_ms == OLDEST_AGE
    assert proofs.build(state, verb, 500.1).input_count == 1


def test_the_flags_of_a_verb_say_whether_its_demand_moves() -> None:
    verb = VerbOperator(heard_contact(4.0), SessionProofs(7), [])
    for moves in (False, True, False):
        verb.send_demand(DEMAND, 5.0, moves=moves)
        assert bool(verb.flags(5.0) & OperatorFlag.DEADMAN) == moves
