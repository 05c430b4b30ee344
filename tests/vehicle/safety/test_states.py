"""The state table, cell by cell."""

from __future__ import annotations

import pytest

from vehicle.safety.states import TRANSITIONS, Event, State

B, S, A, E, F, O = State  # noqa: E741

EXPECTED = {
    Event.READY: {B: S},
    Event.ARM: {S: A},
    Event.DISARM: {A: S},
    Event.STOP: {B: E, S: E, A: E, F: E},
    Event.RELEASE: {E: S},
    Event.FAIL: {B: F, S: F, A: F},
    Event.REPAIR: {F: S},
    Event.SHUTDOWN: {B: O, S: O, A: O, E: O, F: O},
}
"""What changes; every other cell stays as it is."""


@pytest.mark.parametrize("event", Event)
@pytest.mark.parametrize("state", State)
def test_every_cell(state: State, event: Event) -> None:
    assert TRANSITIONS[state, event] is EXPECTED[event].get(state, state)


def test_the_table_has_no_other_cells() -> None:
    assert len(TRANSITIONS) == len(State) * len(Event)


def test_only_arming_from_safe_leads_to_armed() -> None:
    assert [cell for cell, after in TRANSITIONS.items() if after is A and cell[0] is not A] == [(S, Event.ARM)]
