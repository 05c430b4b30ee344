"""Every stop in every autonomous mode, and commands that must not move the rover. First it moves, then not."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from dialects.axes import Axes
from dialects.enums import Command, Result
from dialects.modes import Mode
from tests.examples import examples
from tests.vehicle.bench import CYCLE, DRIVER, NEUTRAL, OTHER
from tests.vehicle.field import Field
from tests.vehicle.missions import upload, way
from vehicle.modes import MODES
from vehicle.navigation.geo import Point
from vehicle.safety.failsafe import FailsafeAction
from vehicle.safety.states import SafetyState


def twist(field: Field) -> None:
    field.begin(Mode.GUIDED)
    field.stream(2.0, 0.8)


def place(field: Field) -> None:
    field.begin(Mode.GUIDED)
    field.goto(30.0, 0.0)
    field.beat(3.0)


def auto(field: Field) -> None:
    upload(field, way(30, 0))
    field.arm()
    field.command(Command.MISSION_START)
    field.beat(3.0)


def by_hand(field: Field) -> None:
    field.arm()
    field.wait(0.2, NEUTRAL)
    field.wait(10.0, Axes(1.0))


def home(field: Field) -> None:
    by_hand(field)
    field.set_mode(Mode.RTL)
    field.beat(5.0)


def back(field: Field) -> None:
    by_hand(field)
    field.set_mode(Mode.SMART_RTL)
    field.beat(5.0)


def acro(field: Field) -> None:
    field.begin(Mode.ACRO)
    field.wait(0.2, NEUTRAL)
    field.wait(1.0, Axes(1.0))


DRIVES: list[Callable[[Field], None]] = [twist, place, auto, home, back, acro]
STOPS: dict[str, tuple[float, ...]] = {
    "disarm": (Command.COMPONENT_ARM_DISARM, 0),
    "emergency stop": (Command.DO_SET_SAFETY_SWITCH_STATE, 0),
    "termination": (Command.DO_FLIGHTTERMINATION, 1),
    "hold": (Command.DO_SET_MODE, 1, Mode.HOLD),
    "pause": (Command.DO_PAUSE_CONTINUE, 0),
}


@pytest.mark.parametrize("stop", STOPS)
@pytest.mark.parametrize("drive", DRIVES, ids=lambda drive: drive.__name__)
def test_every_stop_of_any_station_stops_every_mode(drive: Callable[[Field], None], stop: str) -> None:
    field = Field()
    drive(field)
    assert field.turning
    command, *params = STOPS[stop]
    assert field.command(int(command), *params, system=OTHER) is Result.ACCEPTED
    field.wait(0.05)
    assert not field.turning or stop in ("hold", "pause")
    field.wait(1.0)
    field.heartbeat()
    assert field.stands_for(3.0)


@pytest.mark.parametrize("drive", DRIVES, ids=lambda drive: drive.__name__)
def test_a_lost_ground_station_ends_every_mode_in_hold(drive: Callable[[Field], None]) -> None:
    field = Field()
    drive(field)
    assert field.turning
    field.wait(7.0)
    assert field.mode is Mode.HOLD
    assert field.stands_for(2.0)
    field.beat(3.0)
    assert field.stands_for(1.0)  # a returning ground station starts nothing


def test_an_armed_rover_without_a_driver_does_not_drive_itself() -> None:
    """Nobody's silence would end it: the failsafe of a lost ground station has acted before."""
    field = Field()
    auto(field)
    assert field.turning
    field.command(Command.REQUEST_OPERATOR_CONTROL, 0)
    field.beat(6.0)
    assert field.armed
    for mode in (Mode.AUTO, Mode.RTL, Mode.LOITER, Mode.GUIDED):
        assert field.set_mode(mode, OTHER) is Result.FAILED
    assert field.command(Command.MISSION_START, system=OTHER) is Result.FAILED
    assert any("no GCS is in control" in text for text in field.texts)
    assert field.mode is Mode.HOLD
    assert field.stands_for(1.0)
    field.command(Command.REQUEST_OPERATOR_CONTROL, 1, system=OTHER)
    assert field.set_mode(Mode.AUTO, OTHER) is Result.ACCEPTED
    field.wait(1.0)
    assert field.turning


@pytest.mark.parametrize("drive", [place, auto, home, back], ids=lambda drive: drive.__name__)
def test_a_lost_position_ends_modes_that_require_one(drive: Callable[[Field], None]) -> None:
    field = Field()
    drive(field)
    assert field.turning
    field.blind = {"latitude": None}
    field.beat(5.0)
    assert field.mode is Mode.HOLD
    field.blind = {}
    field.beat(1.0)
    assert field.stands_for(2.0)


@pytest.mark.parametrize("drive", [twist, place, auto, home, acro], ids=lambda drive: drive.__name__)
def test_nothing_resumes_by_itself_after_a_motor_failure(drive: Callable[[Field], None]) -> None:
    field = Field()
    drive(field)
    assert field.turning
    field.rover.motor_failed("broken", field.now)
    assert not field.turning
    field.rover.motor_repaired(field.now)
    field.wait(1.0)
    assert field.arm() is Result.ACCEPTED
    assert field.stands_for(3.0)


Step = tuple[Any, ...]
OWN = [Mode.GUIDED, Mode.AUTO, Mode.RTL, Mode.SMART_RTL, Mode.LOITER, Mode.MANUAL, Mode.HOLD]
SYSTEMS = st.sampled_from([DRIVER, DRIVER, OTHER])
STEPS = st.one_of(
    st.tuples(st.just("wait"), st.sampled_from([0.1, 0.5, 1.2, 3.0])),
    st.tuples(st.just("arm"), SYSTEMS),
    st.tuples(st.just("order"), st.just(Command.COMPONENT_ARM_DISARM), st.just(0.0), SYSTEMS),
    st.tuples(st.just("order"), st.just(Command.DO_SET_SAFETY_SWITCH_STATE), st.sampled_from([0.0, 1.0]), SYSTEMS),
    st.tuples(st.just("order"), st.just(Command.MISSION_START), st.just(0.0), SYSTEMS),
    st.tuples(st.just("order"), st.just(Command.DO_PAUSE_CONTINUE), st.sampled_from([0.0, 1.0]), SYSTEMS),
    st.tuples(st.just("mode"), st.sampled_from(OWN), SYSTEMS),
    st.tuples(st.just("twist"), st.sampled_from([0.8, -0.8, 0.0]), SYSTEMS),
    st.tuples(st.just("go"), st.sampled_from([(20.0, 0.0), (-5.0, 5.0)])),
    st.tuples(st.just("blind"), st.booleans()),
    st.tuples(st.just("freeze"), st.sampled_from([0.05, 0.15, 0.3])),
)


@dataclass
class Witness:
    """Checks motion against its own commands and the reported state only."""

    field: Field
    asked: bool = False
    """The station in control requested autonomous motion since the vehicle was armed."""
    before: tuple[float, ...] = (0.0, 0.0)

    def play(self, step: Step) -> None:
        getattr(self, step[0])(*step[1:])
        self.check()

    def check(self) -> None:
        rover = self.field.rover
        outputs = rover.outputs
        if rover.state is not SafetyState.ARMED:
            self.asked = False
            assert not any(outputs.throttles)
            assert not outputs.enabled
        held = (
            rover._safety.failsafes.lasting_action(self.field.now) >= FailsafeAction.NEUTRAL
            or not MODES[rover._safety.mode].moves
        )
        if held or not self.asked:
            assert all(abs(new) <= abs(old) for new, old in zip(outputs.throttles, self.before, strict=True))
        assert all(abs(value) <= 1.0 for value in outputs.throttles)
        self.before = outputs.throttles

    def wait(self, seconds: float) -> None:
        self.field.heartbeat()
        for _ in range(round(seconds / CYCLE)):
            self.field.wait(CYCLE)
            self.check()

    def arm(self, system: int) -> None:
        was = self.field.armed
        self.field.arm(system)
        if not was:
            self.asked = False

    def order(self, command: int, first: float, system: int) -> None:
        answer = self.field.command(command, first, system=system)
        self.asked |= self.field.armed and command == Command.MISSION_START and answer is Result.ACCEPTED

    def mode(self, mode: Mode, system: int) -> None:
        self.asked |= self.field.set_mode(mode, system) is Result.ACCEPTED and self.field.armed

    def twist(self, speed: float, system: int) -> None:
        self.field.twist(speed, system=system)
        self.asked |= self.field.armed and system == self.field.rover._control.ownership.owner

    def go(self, place: tuple[float, float]) -> None:
        if self.field.reposition(Point(*place)) is Result.ACCEPTED:
            self.asked = True

    def blind(self, yes: bool) -> None:
        self.field.blind = {"gps_fix": None} if yes else {}

    def freeze(self, seconds: float) -> None:
        self.field.freeze(seconds)
        self.field.cycle()


@settings(max_examples=examples(40))
@given(st.lists(STEPS, max_size=25))
def test_no_command_moves_a_disarmed_stopped_or_failing_rover(steps: list[Step]) -> None:
    field = Field()
    upload(field, way(20, 0), way(20, 20))
    witness = Witness(field)
    for step in steps:
        witness.play(step)


def test_the_rover_can_move_in_this_test() -> None:
    field = Field()
    upload(field, way(20, 0))
    witness = Witness(field)
    for step in (("arm", DRIVER), ("order", Command.MISSION_START, 0.0, DRIVER), ("wait", 3.0)):
        witness.play(step)
    assert field.turning
