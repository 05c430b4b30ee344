"""What the outputs of an ArduPilot rover drive, by its parameters."""

from __future__ import annotations

import pytest

from dialects import messages as m
from groundstation.intents.session import ReportKeyReleases
from groundstation.intents.vehicle import Arm
from tests.fakes.rover import FakeArduPilot
from tests.groundstation.cockpits import FORWARD, Cockpit

FRAMES = {
    "ackermann": ({1: 26, 3: 70}, ["steering servo", "throttle servo"]),
    "skid": ({1: 73, 3: 74}, ["left wheel", "right wheel"]),
    "elsewhere": ({1: 0, 2: 26, 3: 0, 4: 70}, []),
    "no driving function": (dict.fromkeys(range(1, 9), 0), []),
    "not answered": ({}, ["servo 1", "servo 3"]),
}


def cockpit(functions: dict[int, int]) -> tuple[Cockpit, FakeArduPilot]:
    vehicle = FakeArduPilot()
    vehicle.params |= {f"SERVO{channel}_FUNCTION": float(each) for channel, each in functions.items()}
    vehicle.set_pulses("SERVO1", "SERVO3")
    made = Cockpit(vehicle)
    made.run(6.0)
    return made, vehicle


def names(made: Cockpit) -> list[str]:
    return [output.name for output in made.view.outputs]


@pytest.mark.parametrize(("functions", "expected"), FRAMES.values(), ids=FRAMES)
def test_outputs_are_named_by_their_function(functions: dict[int, int], expected: list[str]) -> None:
    """This vehicle sends pulses on outputs 1 and 3 only."""
    assert names(cockpit(functions)[0]) == expected


def test_driving_straight_turns_throttle_and_not_the_steering() -> None:
    made, _ = cockpit({1: 26, 3: 70})
    made.do(Arm(held=1.0))
    made.run(1.5)
    made.do(ReportKeyReleases(), FORWARD)
    made.run(1.0)
    assert {output.name: output.value for output in made.view.outputs} == {
        "steering servo": 0.0,
        "throttle servo": pytest.approx(0.6, abs=0.01),
    }


def test_functions_are_read_again_after_restart_but_not_for_ever() -> None:
    made, vehicle = cockpit({1: 26, 3: 70})
    made.run(20.0)
    asked = [each.param_id for _, each in vehicle.all(m.ParamRequestRead)]
    assert asked.count("SERVO1_FUNCTION") == 1
    assert asked.count("SERVO8_FUNCTION") == 3
    vehicle.params |= {"SERVO1_FUNCTION": 73.0, "SERVO3_FUNCTION": 74.0}
    made.world.cut()
    made.run(4.0)
    made.world.cut(False)
    made.run(4.0)
    assert names(made) == ["left wheel", "right wheel"]


def test_our_own_rover_is_not_asked() -> None:
    made = Cockpit()
    made.run(6.0)
    assert made.vehicle.all(m.ParamRequestRead) == []
