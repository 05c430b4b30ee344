"""Why keys must not drive, as far as the app knows: each reason, and which one comes first."""

from __future__ import annotations

import pytest
from msgspec.structs import fields, replace

from groundstation.ui.keys.gate_checks import AppCondition, find_closure
from groundstation.ui.keys.key_gate import OTHER_SCREEN, GateClosure, GateLevel

FINE = AppCondition(
    leaving=None, station_alive=True, outage="", other_screen=None, detached=False, focus=True, too_small=False,
    terminal_silent=False, terminal_stuck=False,
)  # fmt: skip
QUITTING = GateClosure("quitting")
WRONG: dict[str, tuple[object, str]] = {
    "leaving": (QUITTING, "quitting"),
    "station_alive": (False, "the station has ended"),
    "outage": ("the station does not respond for 1 s", "the station does not respond"),
    "lent": (True, "a log has the terminal"),
    "other_screen": (OTHER_SCREEN, "another screen is open"),
    "replay": (True, "this is a replay"),
    "driver": ("screen on pts/4", "screen on pts/4 drives"),
    "detached": (True, "nobody is attached to tmux"),
    "focus": (False, "this window does not have the focus"),
    "too_small": (True, "the terminal is too small"),
    "terminal_silent": (True, "the terminal does not answer"),
    "terminal_stuck": (True, "the terminal accepts no output"),
    "style": ("latch drives on", "latch drives on"),
}


def test_keys_drive_when_nothing_is_wrong() -> None:
    assert find_closure(FINE) is None
    assert set(WRONG) == {field.name for field in fields(AppCondition)}


@pytest.mark.parametrize("name", WRONG)
def test_each_condition_alone_keeps_keys_from_driving(name: str) -> None:
    value, reason = WRONG[name]
    closure = find_closure(replace(FINE, **{name: value}))
    assert closure is not None
    assert closure.reason == reason


def test_the_first_in_the_table_is_the_one_that_is_shown() -> None:
    for later in range(1, len(WRONG)):
        first, second = list(WRONG)[later - 1 : later + 1]
        both = replace(FINE, **{first: WRONG[first][0], second: WRONG[second][0]})
        closure = find_closure(both)
        assert closure is not None
        assert closure.reason == WRONG[first][1]


def test_a_proposal_is_permitted_on_another_screen() -> None:
    other = GateClosure(OTHER_SCREEN.reason, GateLevel.STOPS, frozenset("p"))
    assert find_closure(replace(FINE, other_screen=other)) == other
    for name, (value, _) in WRONG.items():
        if name != "other_screen":
            closure = find_closure(replace(FINE, **{"other_screen": other, name: value}))
            assert closure is not None
            assert not closure.agent_keys, name
