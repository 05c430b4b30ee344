"""Groups of vehicles, as [groups] and `--group` say them."""

from __future__ import annotations

import pytest

from groundstation.config.groups import EVERYBODY, GroupError, parse_group


def test_ids_ranges_and_patterns() -> None:
    group = parse_group(["1-3, 7", "*Boat*"])
    heard = [(1, "Rover 1"), (3, "Rover 3"), (4, "Rover 4"), (7, "Rover 7"), (9, "Surface boat 9")]
    assert [system for system, name in heard if group.has(system, name)] == [1, 3, 7, 9]
    assert group.listed == {7}, "of a range those that are heard"
    assert EVERYBODY.has(255, "Vehicle 255")
    assert EVERYBODY.has(1, "")
    assert parse_group("Rover1, gps*").has(9, "rover1", "Rover 9"), "the name in the fleet, and kind and system id"
    assert not parse_group("rover1").has(1, "", "Rover 1")
    assert parse_group("Rover1, gps*, 7").named == {"rover1"}, "vehicles to wait for, unlike those of a pattern"


@pytest.mark.parametrize("text", ["", "0", "256", "5-3", "1,,2", "1-2-3", "-"])
def test_a_text_that_names_no_vehicles(text: str) -> None:
    with pytest.raises(GroupError):
        parse_group(text)
