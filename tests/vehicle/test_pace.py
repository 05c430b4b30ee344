"""A rover with nothing under way, disarmed or driven steadily, senses every 0.1 s, and else in each control cycle."""

from __future__ import annotations

from collections.abc import Sequence

import pytest

from dialects import messages as m
from dialects.axes import Axes, build_manual_control
from dialects.enums import Command, Result
from dialects.modes import Mode
from link.core import LinkReport, Received
from tests.vehicle.bench import AHEAD, CYCLE, EVERYTHING, NEUTRAL, Bench
from vehicle.control_loop import ControlLoop
from vehicle.motors.simulated import SimulatedMotors
from vehicle.pace import BUSY_TIME, PERIOD
from vehicle.readings import Readings
from vehicle.safety.states import SafetyState

TURN = Axes(throttle=0.5, steering=0.3)
DISARM_BUTTON = 3


class CountingMotors(SimulatedMotors):
    written = 0
    """How often they were set."""

    def set(self, throttles: Sequence[float]) -> None:
        self.written += 1
        super().set(throttles)


class Machine(Bench):
    """The bench with the control loop around the rover. The emergency stop is a plain attribute."""

    loop: ControlLoop | None = None
    driver: CountingMotors | None = None
    pressed: str | None = None
    sensed = 0
    """Whole cycles so far."""

    @property
    def body(self) -> ControlLoop:
        self.loop = self.loop or ControlLoop(self.rover, self.motors, self, stop_input=lambda: self.pressed)
        return self.loop

    @property
    def motors(self) -> CountingMotors:
        self.driver = self.driver or CountingMotors()
        return self.driver

    @property
    def turning(self) -> bool:
        return any(self.motors.outputs)

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


def test_a_rover_that_was_just_armed_works_in_each_cycle_and_drives_at_once(idle: Machine) -> None:
    assert idle.arm() is Result.ACCEPTED
    assert idle.whole_cycles(1.0, NEUTRAL) == 50
    idle.stick(AHEAD)
    assert idle.turning


@pytest.fixture
def cruising(idle: Machine) -> Machine:
    """Driven ahead at the same throttle for so long that nothing is under way."""
    return cruise(idle)


def cruise(machine: Machine, axes: Axes = AHEAD) -> Machine:
    machine.arm()
    machine.wait(0.5, NEUTRAL)
    machine.wait(BUSY_TIME + 2.0, axes)
    assert machine.turning
    return machine


def test_a_rover_that_is_driven_steadily_works_every_tenth_of_a_second(cruising: Machine) -> None:
    assert cruising.whole_cycles(5.0, AHEAD) == pytest.approx(5.0 / PERIOD, abs=1)
    assert cruising.turning


def test_its_motors_are_written_in_each_cycle(cruising: Machine) -> None:
    before = cruising.motors.written
    cruising.wait(1.0, AHEAD)
    assert cruising.motors.written - before >= 50


@pytest.mark.parametrize("after", range(5))
def test_another_demand_reaches_the_motors_at_once_and_ends_the_short_cycles(cruising: Machine, after: int) -> None:
    cruising.wait(after * CYCLE)
    before = cruising.motors.outputs
    cruising.stick(TURN)
    assert cruising.motors.outputs != before
    assert cruising.whole_cycles(PERIOD, TURN) == 5


@pytest.mark.parametrize("after", range(5))
def test_a_steady_demand_that_ends_stops_the_wheels_in_time(cruising: Machine, after: int) -> None:
    cruising.wait(1.0 + after * CYCLE, AHEAD)
    began = cruising.now
    while cruising.turning and cruising.now < began + 2.0:
        cruising.wait(CYCLE)
        if cruising.now > began + 0.47:
            assert cruising.motors.outputs < (1.0, 1.0)
    assert cruising.now < began + 1.0
    assert cruising.rover.state is SafetyState.ARMED
    cruising.stick(AHEAD)  # not neutral first
    cruising.wait(CYCLE)
    assert not cruising.turning


@pytest.mark.parametrize("after", range(5))
def test_the_emergency_stop_is_read_in_each_short_cycle(cruising: Machine, after: int) -> None:
    cruising.wait(after * CYCLE, AHEAD)
    cruising.pressed = "pressed"
    cruising.wait(CYCLE)
    assert not cruising.turning
    assert cruising.rover.state is SafetyState.ESTOP


def test_a_late_cycle_behind_short_ones_has_no_power(cruising: Machine) -> None:
    cruising.freeze(0.15)
    cruising.stick(AHEAD)  # repeats the last demand; read before the cycle that is late
    assert not cruising.turning
    cruising.cycle()
    assert not cruising.turning


def test_a_condition_of_a_failsafe_is_watched_in_each_cycle(cruising: Machine) -> None:
    cruising.readings = Readings(roll=1.0)  # tilted, and disarmed after 0.5 s
    cruising.wait(PERIOD, AHEAD)
    assert cruising.whole_cycles(0.3, AHEAD) == 15
    cruising.wait(0.3, AHEAD)
    assert not cruising.turning
    assert cruising.rover.state is SafetyState.SAFE


def test_a_fence_needs_the_position_in_each_cycle() -> None:
    machine = Machine(FS_GCS_ENABLE=0, FENCE_ENABLE=1, FENCE_TYPE=2, FENCE_RADIUS=500)
    machine.readings = EVERYTHING
    machine.wait(BUSY_TIME + 1.0)
    assert cruise(machine).whole_cycles(1.0, AHEAD) == 50


def test_a_mode_that_needs_the_gyro_senses_in_each_cycle(idle: Machine) -> None:
    idle.readings = Readings(yaw_rate=0.0)
    idle.wait(1.0)
    assert idle.set_mode(Mode.ACRO) is Result.ACCEPTED
    assert cruise(idle).whole_cycles(1.0, AHEAD) == 50


def test_a_button_is_obeyed_at_once_while_driving_steadily() -> None:
    cruising = cruise(Machine(FS_GCS_ENABLE=0, **{f"BTN{DISARM_BUTTON}_FUNCTION": 2}))
    assert cruising.whole_cycles(1.0, AHEAD) == pytest.approx(1.0 / PERIOD, abs=1)
    stop = build_manual_control(AHEAD, 1)
    stop.buttons = 1 << DISARM_BUTTON
    cruising.say(stop)
    assert not cruising.turning
    assert cruising.rover.state is SafetyState.SAFE


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
