"""A rover that is driven steadily senses every 0.1 s; what stops it does so as if it sensed in each cycle."""

from __future__ import annotations

from itertools import pairwise

import pytest

from dialects import messages as m
from dialects.axes import Axes, build_manual_control
from dialects.enums import Result
from dialects.modes import Mode
from tests.vehicle.bench import AHEAD, CYCLE, EVERYTHING, NEUTRAL
from tests.vehicle.pacing import Machine, cruise, idle_machine
from vehicle.pace import BUSY_TIME, PERIOD
from vehicle.readings import Readings
from vehicle.safety.states import SafetyState
from vehicle.sensors.encoders import WheelSpeedFilter

TURN = Axes(throttle=0.5, steering=0.3)
DISARM_BUTTON = 3
SPEED = 0.53
"""m/s"""
SLOT = 0.0102
"""m of way for each count of an encoder."""


@pytest.fixture
def idle() -> Machine:
    return idle_machine()


@pytest.fixture
def cruising(idle: Machine) -> Machine:
    """Driven ahead at the same throttle for so long that nothing is under way."""
    return cruise(idle)


def test_a_steadily_driven_rover_works_every_tenth_of_a_second(cruising: Machine) -> None:
    assert cruising.whole_cycles(5.0, AHEAD) == pytest.approx(5.0 / PERIOD, abs=1)
    assert cruising.turning


def test_its_motors_are_written_in_each_cycle(cruising: Machine) -> None:
    before = cruising.motors.written
    cruising.wait(1.0, AHEAD)
    assert cruising.motors.written - before >= 50


@pytest.mark.parametrize("after", range(5))
def test_new_demand_reaches_the_motors_at_once_and_ends_resting(cruising: Machine, after: int) -> None:
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


def test_the_vehicle_clock_is_sent_on_time_between_whole_cycles(cruising: Machine) -> None:
    times: list[float] = []
    for _ in range(500):
        before = len(cruising.all(m.RoverDriveStatus))
        cruising.wait(CYCLE, AHEAD)
        times += [cruising.now] * (len(cruising.all(m.RoverDriveStatus)) - before)
    assert cruising.turning
    assert len(times) == pytest.approx(50, abs=1)
    assert max(later - earlier for earlier, later in pairwise(times)) < 0.2 + 1.5 * CYCLE


@pytest.mark.parametrize("after", range(5))
def test_an_absent_operator_is_found_in_the_cycle_it_is_due(after: int) -> None:
    machine = Machine(FS_GCS_ENABLE=0, OPR_TIMEOUT=5)
    machine.wait(BUSY_TIME + 1.0 + after * CYCLE)
    machine.arm()
    machine.wait(0.5, NEUTRAL)
    machine.meet()  # with an input just now
    due = machine.now + 5.0
    while machine.throttles != (1.0, 1.0):
        machine.wait(CYCLE, AHEAD)
    machine.wait(due - machine.now - 1.5 * CYCLE, AHEAD)
    assert machine.whole_cycles(0.0) <= 1
    assert machine.throttles == (1.0, 1.0)
    machine.wait(3.5 * CYCLE, AHEAD)
    assert machine.throttles < (1.0, 1.0)


@pytest.mark.parametrize("after", range(5))
def test_an_idle_driver_is_disarmed_in_the_cycle_it_is_due(after: int) -> None:
    machine = Machine(FS_GCS_ENABLE=0, DISARM_DELAY=6)
    machine.wait(BUSY_TIME + 1.0 + after * CYCLE)
    machine.arm()
    armed_at = machine.now
    machine.wait(6.0 - 0.5 * CYCLE, NEUTRAL)
    assert machine.armed
    machine.wait(1.5 * CYCLE, NEUTRAL)
    assert machine.now - armed_at < 6.0 + 1.5 * CYCLE
    assert not machine.armed


def test_a_battery_below_its_limit_is_watched_in_each_cycle(cruising: Machine) -> None:
    cruising.readings = Readings(battery_voltage=5.0)
    cruising.wait(PERIOD, AHEAD)
    assert cruising.whole_cycles(1.0, AHEAD) == 50


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


class WithEncoders(Machine):
    """Its wheels turn at SPEED all the time; the encoders count slots."""

    def __init__(self, **params: float) -> None:
        self.wheels = (WheelSpeedFilter(SLOT), WheelSpeedFilter(SLOT))
        super().__init__(**params)

    def read(self, now: float) -> Readings:
        slots = int(now * SPEED / SLOT)
        speeds = tuple(wheel.update(slots, now) for wheel in self.wheels)
        self.readings = Readings(yaw=0.0, wheel_speeds=speeds, speed=sum(speeds) / len(speeds))
        return super().read(now)


def test_the_odometer_loses_no_way_between_whole_cycles() -> None:
    machine = cruise(WithEncoders(FS_GCS_ENABLE=0))
    before = machine.newest(m.LocalPositionNed)
    assert machine.whole_cycles(30.0, AHEAD) < 400
    after = machine.newest(m.LocalPositionNed)
    seconds = (after.time_boot_ms - before.time_boot_ms) / 1000
    assert after.x - before.x == pytest.approx(seconds * SPEED, abs=2 * SLOT)
