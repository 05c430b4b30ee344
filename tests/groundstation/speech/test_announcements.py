"""What is said of a vehicle: each change once, and what must not be missed before the rest."""

from __future__ import annotations

from typing import Any

import msgspec

from groundstation.speech.announcements import Priority, SpokenState, StateAnnouncer

HOLD = SpokenState("Rover 1", alive=True, armed=False, mode="HOLD", stands=True)
DRIVING = msgspec.structs.replace(HOLD, armed=True, mode="MANUAL", stands=False, driver="you")


def said(before: SpokenState | None, **changes: Any) -> list[tuple[str, str]]:
    announcer = StateAnnouncer()
    announcer.update(before)
    after = msgspec.structs.replace(before or HOLD, **changes)
    found = announcer.update(after)
    assert announcer.update(after) == []
    return [(each.priority.name, each.text) for each in found]


def test_a_vehicle_that_appears_is_described_in_one_sentence() -> None:
    assert said(None) == [("CHANGE", "Rover 1: HOLD, disarmed")]
    assert said(None, failsafes=("gcs loss",)) == [
        ("URGENT", "failsafe: gcs loss"), ("CHANGE", "Rover 1: HOLD, disarmed"),
    ]  # fmt: skip
    assert said(DRIVING, name="Rover 2") == [("CHANGE", "Rover 2: MANUAL, armed")]


def test_stops_and_losses_are_urgent() -> None:
    for changes, text in (
        ({"alive": False}, "link lost"),
        ({"emergency_stop": True}, "emergency stop"),
        ({"failsafes": ("battery",)}, "failsafe: battery"),
        ({"breach": "outside the fence"}, "outside the fence"),
        ({"armed": False}, "disarmed"),
        ({"mode": "HOLD", "stands": True}, "stop: HOLD"),
    ):
        assert said(DRIVING, **changes) == [(Priority.URGENT.name, text)]


def test_what_is_urgent_comes_first() -> None:
    changed = {"mode": "AUTO", "driver": "nobody", "alive": False}
    assert [text for _, text in said(DRIVING, **changed)] == ["link lost", "mode AUTO", "in control: nobody"]


def test_a_failsafe_that_ends_is_not_said() -> None:
    assert said(msgspec.structs.replace(DRIVING, failsafes=("battery",)), failsafes=()) == []
