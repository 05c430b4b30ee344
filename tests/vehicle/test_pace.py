"""A disarmed rover with nothing under way does the work of a control cycle every 0.1 s, and else in each cycle."""

from __future__ import annotations

import pytest

from dialects import messages as m
from dialects.axes import Axes
from dialects.enums import Command, Result
from link.core import LinkReport, Received
from tests.vehicle.bench import AHEAD, CYCLE, NEUTRAL, Bench
from vehicle.control_loop import ControlLoop
from vehicle.motors.simulated import SimulatedMotors
from vehicle.pace import BUSY_TIME, PERIOD
from vehicle.readings import Readings
from vehicle.safety.states import SafetyState


class Machine(Bench):
    """The bench with the control loop around the rover. The emergency stop is a plain attribute."""

    loop: ControlLoop | None = None
    pressed: str | None = None
    sensed = 0
    """Whole cycles so far."""

    @property
    def body(self) -> ControlLoop:
        self.loop = self.loop or ControlLoop(self.rover, SimulatedMotors(), self, stop_input=lambda: self.pressed)
        return self.loop

    def read(self, now: float) -> Readings:
        self.sensed += 1
        return self.readings

    def _tick(self) -> None:
        self.body.tick(self.now)

    def _receive(self, received: Received) -> None:
        self.body.receive(received, self.now)

    def whole_cycles(self, seconds: float, axes: Axes | None = None) -> int:
        before = self.sensed
        self.wait(seconds, axes)
        return self.sensed - before


@pytest.fixture
def idle() -> Machine:
    machine = Machine(FS_GCS_ENABLE=0)
    machine.wait(BUSY_TIME + 1.0)
    return machine


def test_an_idle_rover_works_every_tenth_of_a_second(idle: Machine) -> None:
    assert idle.whole_cycles(5.0) == pytest.approx(5.0 / PERIOD, abs=1)


def test_what_comes_all_the_time_keeps_it_idle(idle: Machine) -> None:
    before = idle.sensed
    for _ in range(20):
        idle.heartbeat()
        idle.meet()
        idle.wait(0.25, NEUTRAL)
    assert idle.sensed - before == pytest.approx(5.0 / PERIOD, abs=1)


def test_streams_keep_their_rates(idle: Machine) -> None:
    before = len(idle.all(m.Heartbeat)), len(idle.all(m.SysStatus))
    idle.wait(10.0)
    assert [len(idle.all(kind)) - count for kind, count in zip((m.Heartbeat, m.SysStatus), before, strict=True)] == [
        pytest.approx(10, abs=1)
    ] * 2


@pytest.mark.parametrize("after", range(5))
def test_the_emergency_stop_is_read_in_each_cycle(idle: Machine, after: int) -> None:
    idle.wait(after * CYCLE)
    idle.pressed = "pressed"
    idle.wait(CYCLE)
    assert idle.rover.state is SafetyState.ESTOP


def test_an_armed_rover_works_in_each_cycle_and_drives_at_once(idle: Machine) -> None:
    assert idle.arm() is Result.ACCEPTED
    assert idle.whole_cycles(1.0, NEUTRAL) == 50
    idle.stick(AHEAD)
    assert idle.turning
    assert idle.whole_cycles(BUSY_TIME + 1.0, AHEAD) == round((BUSY_TIME + 1.0) / CYCLE)


def test_a_motor_test_runs_in_each_cycle_to_its_end(idle: Machine) -> None:
    assert idle.command(Command.DO_MOTOR_TEST, 1, 0, 20, 3) is Result.ACCEPTED
    before, turned = idle.sensed, 0
    for _ in range(145):
        idle.heartbeat()
        idle.wait(CYCLE)
        turned += idle.turning
    assert (idle.sensed - before, turned) == (145, 145)
    idle.wait(0.2)
    assert not idle.turning


def test_a_loop_that_was_late_is_not_idle(idle: Machine) -> None:
    idle.freeze(1.0)
    assert idle.whole_cycles(CYCLE) >= 1


def test_a_parameter_list_arrives_as_fast_as_from_a_busy_rover(idle: Machine) -> None:
    idle.say(m.ParamRequestList(1, 1))
    idle.wait(1.0)
    first = len(idle.all(m.ParamValue))
    idle.say(m.ParamRequestList(1, 1))
    idle.wait(1.0)
    assert len(idle.all(m.ParamValue)) - first == first > 50


def test_a_fast_stream_is_fast_while_the_rover_is_idle(idle: Machine) -> None:
    idle.command(Command.SET_MESSAGE_INTERVAL, m.SysStatus.id, 20_000)
    idle.body.observe([LinkReport("udpin:127.0.0.1:14550", audience=(idle.station,))], idle.now)
    idle.wait(BUSY_TIME + 1.0)
    before = len(idle.all(m.SysStatus))
    idle.wait(1.0)
    assert len(idle.all(m.SysStatus)) - before >= 45
