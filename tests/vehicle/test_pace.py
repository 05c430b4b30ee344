"""A disarmed rover with nothing under way works every 0.1 s, and else in each control cycle."""

from __future__ import annotations

import pytest

from dialects import messages as m
from dialects.enums import Command, Result
from link.core import LinkReport
from tests.vehicle.bench import AHEAD, CYCLE, NEUTRAL, logged
from tests.vehicle.pacing import Machine, idle_machine
from vehicle.pace import BUSY_TIME, PERIOD, REST_PERIOD
from vehicle.safety.states import SafetyState


@pytest.fixture
def idle() -> Machine:
    return idle_machine()


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


def test_just_armed_rover_works_in_each_cycle_and_drives_at_once(idle: Machine) -> None:
    assert idle.arm() is Result.ACCEPTED
    assert idle.whole_cycles(1.0, NEUTRAL) == 50
    idle.stick(AHEAD)
    assert idle.turning


def test_a_rover_rests_until_something_is_under_way(idle: Machine) -> None:
    assert idle.body.rest_period == REST_PERIOD
    assert idle.arm() is Result.ACCEPTED
    assert not idle.body.rest_period
    assert idle.command(Command.COMPONENT_ARM_DISARM, 0) is Result.ACCEPTED
    assert not idle.body.rest_period
    idle.wait(BUSY_TIME + 1.0)
    assert idle.body.rest_period


def test_a_newcomer_ends_the_rest_and_the_next_beat_does_not(idle: Machine) -> None:
    idle.heartbeat(system=77)
    assert idle.body.rest_period is None
    idle.wait(BUSY_TIME + 1.0)
    idle.heartbeat(system=77)
    assert idle.body.rest_period == REST_PERIOD


def test_a_message_during_a_rest_sees_the_emergency_stop(idle: Machine) -> None:
    idle.freeze(0.09)
    idle.pressed = "pressed"
    assert idle.arm() is not Result.ACCEPTED
    assert idle.rover.state is SafetyState.ESTOP


@pytest.mark.parametrize("pause", [0.099, REST_PERIOD - 0.001, REST_PERIOD + CYCLE - 0.001])
def test_a_rover_that_is_armed_during_a_rest_is_not_late(idle: Machine, pause: float) -> None:
    idle.freeze(pause)
    assert idle.arm() is Result.ACCEPTED
    idle.wait(0.5, NEUTRAL)
    assert idle.armed


def test_a_rest_that_was_too_long_is_a_late_cycle(idle: Machine) -> None:
    idle.freeze(0.5)
    idle.arm()
    assert not idle.armed
    assert logged(idle, "late")


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


def test_a_stream_of_10_hz_keeps_its_rate_while_the_rover_rests(idle: Machine) -> None:
    idle.command(Command.SET_MESSAGE_INTERVAL, m.SysStatus.id, 100_000)
    idle.body.observe([LinkReport("udpin:127.0.0.1:14550", audience=(idle.station,))], idle.now)
    idle.wait(BUSY_TIME + 1.0)
    assert idle.body.rest_period == PERIOD
    before = len(idle.all(m.SysStatus))
    idle.wait(2.0)
    assert len(idle.all(m.SysStatus)) - before == pytest.approx(20, abs=1)


def test_a_fast_stream_is_fast_while_the_rover_is_idle(idle: Machine) -> None:
    idle.command(Command.SET_MESSAGE_INTERVAL, m.SysStatus.id, 20_000)
    idle.body.observe([LinkReport("udpin:127.0.0.1:14550", audience=(idle.station,))], idle.now)
    idle.wait(BUSY_TIME + 1.0)
    before = len(idle.all(m.SysStatus))
    idle.wait(1.0)
    assert len(idle.all(m.SysStatus)) - before >= 45
