"""Operator intents and what the station does with each."""

from __future__ import annotations

import math

import pytest

from dialects import messages as m
from dialects.enums import Command
from groundstation.actions import ACTIONS
from groundstation.intents.driving import ClearEmergencyStop, DriveKeyDown, SetStyle, StepLimits, Stop
from groundstation.intents.session import Quit, ReportKeyReleases, SetKeyGate
from groundstation.intents.vehicle import Arm, CutMotors, SelectVehicle, TakeOff
from groundstation.intents.vehicle_intent import VehicleIntent
from tests.groundstation.cockpits import FORWARD, Cockpit, armed_cockpit, driving_cockpit


def test_style_changes_are_logged_and_latch_drives_without_a_key() -> None:
    cockpit = armed_cockpit()
    cockpit.do(SetStyle(style="next"), FORWARD)
    cockpit.run(3.0)
    assert cockpit.operator.style == "latch"
    assert cockpit.demands()[-1][1] == 600
    assert "drive style latch" in cockpit.texts
    cockpit.do(Stop())
    cockpit.run(0.1)
    assert cockpit.demands()[-1][1] == 0


def test_commands_without_a_vehicle_are_logged() -> None:
    cockpit = Cockpit()
    cockpit.world.cut()
    cockpit.do(Arm(held=1.0))
    assert "no vehicle yet" in cockpit.texts


def test_an_unknown_vehicle_cannot_be_selected() -> None:
    cockpit = driving_cockpit()
    cockpit.do(SelectVehicle(system=9))
    cockpit.run(0.2)
    assert cockpit.view.system == 1
    assert cockpit.demands()[-1][1] == 0, "looking for another vehicle lets go of this one"


def test_quit_sends_neutral_five_times_and_finishes() -> None:
    cockpit = driving_cockpit()
    quitting = cockpit.now
    assert not cockpit.station.finished
    cockpit.do(Quit())
    cockpit.run(0.15)
    assert not cockpit.station.finished
    cockpit.run(0.15)
    assert cockpit.station.finished
    demands = cockpit.demands(quitting + 0.001)
    assert {x for _, x, _ in demands} == {0}
    assert len({at for at, _, _ in demands}) == 5
    cockpit.run(2.0)
    assert cockpit.demands(quitting + 0.001) == demands
    assert not [at for at, _ in cockpit.vehicle.all(m.Heartbeat) if at > quitting + 0.3]


def test_quit_without_a_drive_is_finished_at_once() -> None:
    cockpit = Cockpit()
    cockpit.run(1.0)
    cockpit.do(Quit())
    assert cockpit.station.finished


def test_stop_wins_over_a_held_key_until_it_is_pressed_again() -> None:
    cockpit = driving_cockpit()
    stopped = cockpit.now
    cockpit.do(Stop())
    cockpit.run(0.5)
    assert all(x == 0 for _, x, _ in cockpit.demands(stopped + 0.001))
    cockpit.do(DriveKeyDown(key="i", throttle=1, steering=0, repeat=True))  # the key is still down and repeats
    cockpit.run(0.2)
    assert cockpit.demands()[-1][1] == 0


def test_speed_keys_change_the_demand_but_never_make_one() -> None:
    cockpit = armed_cockpit()
    cockpit.do(StepLimits(throttle=0.1, steering=0.1))
    cockpit.run(0.5)
    assert all(x == 0 for _, x, _ in cockpit.demands())
    cockpit.do(ReportKeyReleases(), FORWARD)
    cockpit.run(0.1)
    assert cockpit.demands()[-1][1] == 700


@pytest.mark.parametrize("held", [0.0, 0.99, math.nan])
def test_arming_without_a_held_key_is_refused(held: float) -> None:
    cockpit = Cockpit()
    cockpit.run(1.5)
    cockpit.do(Arm(held=held), ClearEmergencyStop(held=held))
    cockpit.run(1.5)
    assert not cockpit.view.armed
    assert "arming refused: the key was not held for 1 s" in cockpit.texts
    assert "release of the emergency stop refused: the key was not held for 1 s" in cockpit.texts
    assert not cockpit.vehicle.commands(Command.COMPONENT_ARM_DISARM)


def test_arming_is_refused_while_the_screen_lets_no_key_drive() -> None:
    cockpit = Cockpit()
    cockpit.run(1.5)
    cockpit.do(SetKeyGate(open=False, reason="the terminal is too small"), Arm(held=1.0))
    cockpit.run(1.5)
    assert not cockpit.view.armed
    assert "arming refused: the terminal is too small" in cockpit.texts


def test_each_intent_that_held_key_confirms_is_refused_by_table() -> None:
    for action in ACTIONS.values():
        if action.confirm and not action.keeps:
            assert action.intent in {Arm(), ClearEmergencyStop(), TakeOff(), CutMotors()}
            assert isinstance(action.intent, VehicleIntent)
            assert action.intent.confirmed
