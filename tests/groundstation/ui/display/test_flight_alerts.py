"""What a pilot reads of a copter: alerts, hints, and which of them are only for the air."""

from __future__ import annotations

from typing import Any

import pytest

from groundstation.actions import ACTIONS
from groundstation.input.hold_to_confirm import HoldProgress
from groundstation.snapshot import VehicleView
from groundstation.snapshot.drive import HealthLine
from groundstation.ui.display.alerts import AlertLevel, active_alerts
from groundstation.ui.display.display_state import DisplayState
from groundstation.ui.display.hints import hint
from tests.groundstation.ui.examples import helm, snapshot, vehicle
from tests.groundstation.ui.ptys import STANDARD


def copter(**more: Any) -> VehicleView:
    usual = {"name": "Copter 1", "mode": "LOITER", "flies": True, "keys_mode": "LOITER", "may_fall": True,
             "take_off": 3.0, "limits": ()}  # fmt: skip
    return vehicle(**(usual | more))


def shown(view: VehicleView, **more: Any) -> DisplayState:
    return DisplayState(snapshot(vehicle=view, operator=helm(held=(), throttle=0.0)), STANDARD, **more)


ALERTS: list[tuple[VehicleView, AlertLevel, str]] = [
    (copter(gps_fix=1), AlertLevel.DANGER, "Copter 1 has lost its GPS fix: it may drift, land it"),
    (
        copter(health=(HealthLine("estimate", "compass variance 0.90", False),)),
        AlertLevel.DANGER,
        "Copter 1: estimate compass variance 0.90: land it",
    ),
    (
        copter(breach="above the highest altitude of the fence"),
        AlertLevel.DANGER,
        "Copter 1 is above the highest altitude of the fence (LOITER): fly it back",
    ),
    (
        copter(breach="outside the fence", mode="RTL", drivable=False),
        AlertLevel.DANGER,
        "Copter 1 is outside the fence (RTL): fly it back, 1 changes to LOITER",
    ),
    (copter(mode="ALT_HOLD"), AlertLevel.WARNING, "ALT_HOLD drifts with the wind: 1 holds the place"),
    (copter(mode="ALT_HOLD", drift=2.2), AlertLevel.WARNING, "ALT_HOLD drifts with the wind at 2.2 m/s: 1 holds the"),
    (copter(drift=1.6), AlertLevel.DANGER, "no key held, and it drifts at 1.6 m/s: it does not hold its place"),
    (copter(limits=("neutral first",)), AlertLevel.WARNING, "neutral first: release all drive keys"),
]


@pytest.mark.parametrize(("view", "level", "words"), ALERTS, ids=map(str, range(len(ALERTS))))
def test_a_pilot_is_told(view: VehicleView, level: AlertLevel, words: str) -> None:
    assert [(each.level, True) for each in active_alerts(shown(view)) if words in each.text] == [(level, True)]


@pytest.mark.parametrize("changes", [{}, {"may_fall": False, "gps_fix": 1, "drift": 2.0, "mode": "ALT_HOLD"}])
def test_what_hovers_well_or_stands_has_no_alert(changes: dict[str, Any]) -> None:
    assert active_alerts(shown(copter(**changes))) == []


HINTS: list[tuple[VehicleView, str]] = [
    (copter(may_fall=False), "on the ground: hold T to take off to 3 m · ! disarms"),
    (copter(may_fall=False, take_off=12.0, altitude_fence=10.0),
     "on the ground: no take-off to 12 m, its fence is at 10 m · ! disarms"),
    (copter(may_fall=False, take_off=12.5, altitude_fence=20.0),
     "on the ground: hold T to take off to 12.5 m · ! disarms"),
    (copter(), "SPACE hovers, ! lands, X held 2 s: IT FALLS · i flies, w s climb"),
    (copter(mode="RTL", drivable=False),
     "RTL: 1 changes to LOITER · SPACE hovers, ! lands, X held 2 s: IT FALLS"),
]  # fmt: skip


@pytest.mark.parametrize(("view", "words"), HINTS, ids=map(str, range(len(HINTS))))
def test_what_a_pilot_does_next(view: VehicleView, words: str) -> None:
    now = DisplayState(snapshot(vehicle=view), STANDARD.in_flight())
    assert hint(now) == words


def test_the_held_key_says_how_high_it_takes_off() -> None:
    hold = HoldProgress(ACTIONS["vehicle.take_off"], "T", 0.5)
    now = DisplayState(snapshot(vehicle=copter(may_fall=False, take_off=7.5)), STANDARD.in_flight(), hold=hold)
    assert [each.text for each in active_alerts(now)][:1] == ["Take off to 7.5 m: hold T █████░░░░░ 0.5 s"]
