"""The model of the Setup screen: lines of the chain, the cursor, what to do next."""

from __future__ import annotations

import pytest

from groundstation.ui.setup.model import SetupModel, chain_lines
from link.runtime.diagnosis import Health
from tests.groundstation.ui.example_setup import EMPTY, ROWS, WELL, doctor_view


@pytest.mark.parametrize("room", [16, 15, 12, 10, 8])
def test_where_the_room_is_small_what_is_well_shares_lines(room: int) -> None:
    lines = chain_lines(ROWS, room)
    assert tuple(row for line in lines for row in line.rows) == ROWS, "no row is lost"
    assert len(lines) == max(room, 10), "no more than needed, and what is not well keeps its line"
    assert all(row.health is Health.OK for line in lines if len(line.rows) > 1 for row in line.rows)


def test_cursor_begins_at_the_first_fault_and_stays_where_put() -> None:
    model = SetupModel()
    assert model.selected is None
    model.show(doctor_view())
    assert model.selected is not None
    assert model.selected.id == "pre_arm"
    model.move(1, 16)
    assert model.selected.id == "mode"
    model.show(WELL)
    assert model.selected.id == "mode"
    model.move(-100, 16)
    assert model.selected.id == "keys"
    model.move(100, 10)
    assert model.selected.id == "motors"


def test_what_to_do_next_is_what_stops_the_operator_first() -> None:
    model = SetupModel()
    model.show(doctor_view(rows=tuple(reversed(ROWS))))
    assert model.next_steps[0] == "pre-arm: calibrate the compass, outdoors"
    assert len(model.next_steps) == 4


def test_the_verdict() -> None:
    model = SetupModel()
    assert model.verdict == "waiting for the station"
    for view, words in ((EMPTY, "no vehicle yet"), (WELL, "Nothing stops you · arm"), (doctor_view(), "cannot drive")):
        model.show(view)
        assert words in model.verdict


def test_the_keys_of_motors_are_off_after_a_while() -> None:
    model = SetupModel()
    model.show(doctor_view())
    model.begin_test(100.0)
    assert model.press_motor("1", 120.0, repeat=False) is not None
    model.expire(149.0)
    assert model.testing
    model.expire(151.0)
    assert not model.testing
