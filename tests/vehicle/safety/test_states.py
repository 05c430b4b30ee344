"""The state table, cell by cell."""

from __future__ import annotations

from tests.rows import each_row
from vehicle.safety.states import TRANSITIONS, SafetyEvent, SafetyState

B, S, A, E, F, O = SafetyState  # noqa: E741

EXPECTED = {
    SafetyEvent.READY: {B: S},
    SafetyEvent.ARM: {S: A},
    SafetyEvent.DISARM: {A: S},
    SafetyEvent.STOP: {B: E, S: E, A: E, F: E},
    SafetyEvent.RELEASE: {E: S},
    SafetyEvent.FAIL: {B: F, S: F, A: F},
    SafetyEvent.REPAIR: {F: S},
    SafetyEvent.SHUTDOWN: {B: O, S: O, A: O, E: O, F: O},
}
"""What changes; every other cell stays as it is."""


@each_row("event", SafetyEvent)
@each_row("state", SafetyState)
def test_every_cell(state: SafetyState, event: SafetyEvent) -> None:
    assert TRANSITIONS[state, event] is EXPECTED[event].get(state, state)


def test_the_table_has_no_other_cells() -> None:
    assert len(TRANSITIONS) == len(SafetyState) * len(SafetyEvent)


def test_only_arming_from_safe_leads_to_armed() -> None:
    assert [cell for cell, after in TRANSITIONS.items() if after is A and cell[0] is not A] == [(S, SafetyEvent.ARM)]
