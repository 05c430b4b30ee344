"""The rover's body: what reaches the motors, when, and what happens when they fail. The mind here is a script."""

from __future__ import annotations

import pytest

from link.core import Outgoing, Peer, PeerReservation, TimeTeller
from tests.rows import each_row
from tests.vehicle.script import AHEAD, HEARTBEAT, MESSAGE, OFF, TURN, Script, driving, machine
from vehicle.control_loop import MOTOR_RETRY_TIME, ControlLoop
from vehicle.drive.gate import Outputs
from vehicle.motors import MotorError
from vehicle.motors.simulated import SimulatedMotors
from vehicle.sensors import NoSensors

# ---- driving ----


def test_touches_nothing_while_the_rover_is_off() -> None:
    body, _, motors = machine()
    body.tick(0.0)
    body.receive(MESSAGE, 0.01)
    assert motors.asked == []


def test_senses_before_it_decides() -> None:
    body, mind, _ = machine()
    body.tick(0.0)
    assert mind.calls == ["sense", "tick"]


def test_power_comes_before_throttles() -> None:
    body, mind, motors = machine()
    mind.outputs = AHEAD
    body.tick(0.0)
    assert motors.asked == ["enable", "set 0.5 0.4"]


def test_a_message_reaches_the_motors_before_the_next_tick() -> None:
    body, mind, motors = driving()
    mind.next = TURN
    body.receive(MESSAGE, 0.005)
    assert motors.outputs == (0.5, -0.5)


def test_what_the_links_say_reaches_the_motors() -> None:
    body, mind, motors = driving()
    mind.outputs = OFF
    body.observe([], 0.005)
    assert not motors.enabled


def test_messages_write_only_changes() -> None:
    body, _, motors = driving()
    for _ in range(50):
        body.receive(MESSAGE, 0.005)
    assert motors.asked == []


def test_each_cycle_writes_so_that_a_drivers_own_timeout_is_fed() -> None:
    body, _, motors = driving()
    body.tick(0.02)
    body.tick(0.04)
    assert motors.asked == ["set 0.5 0.4"] * 2


def test_off_takes_the_power_once() -> None:
    body, mind, motors = driving()
    mind.outputs = OFF
    for cycle in range(5):
        body.tick(0.02 * cycle)
    assert motors.asked == ["disable"]
    assert motors.outputs == (0.0, 0.0)


def test_passes_on_what_the_rover_says() -> None:
    body, _, _ = machine()
    assert body.messages_to_send() == [Outgoing(HEARTBEAT)]


def test_the_links_reserve_places_for_the_driver_of_the_rover() -> None:
    """The runner asks the loop, not the rover: without this the ids in control had no places."""
    body, mind, _ = machine()
    assert isinstance(body, PeerReservation)
    mind.reserved_ids = (255, 190)
    assert body.reserved_ids == (255, 190)


def test_a_sender_with_a_wrong_time_is_answered_by_the_rover() -> None:
    body, mind, _ = machine()
    assert isinstance(body, TimeTeller)
    body.tell_time(Peer(0, "here"), 0.0)
    assert mind.calls == ["tell_time"]


def test_refuses_a_driver_with_another_number_of_motors() -> None:
    with pytest.raises(MotorError, match="4 motors, this drive needs 2"):
        ControlLoop(Script(), SimulatedMotors(4), NoSensors())


# ---- motors that fail ----


def test_a_driver_that_fails_is_stopped_and_then_told() -> None:
    body, mind, motors = driving()
    motors.broken["set"] = MotorError("no answer on the bus")
    body.tick(0.02)
    assert motors.outputs == (0.0, 0.0)
    assert not motors.enabled
    assert mind.calls == ["sense", "tick", "failed: no answer on the bus"]


def test_a_driver_that_fails_to_enable_is_stopped_and_told() -> None:
    body, mind, motors = machine()
    motors.broken["enable"] = MotorError("no power")
    mind.outputs = AHEAD
    body.tick(0.0)
    assert motors.asked == ["enable", "disable"]
    assert "failed: no power" in mind.calls


def test_unproven_output_is_told_before_motion_and_asked_again() -> None:
    reasons = ["no timeout", "no timeout still"]

    def prove() -> None:
        if reasons:
            raise MotorError(reasons.pop(0))

    body, mind, motors = machine(prove)
    for now in (0.0, MOTOR_RETRY_TIME / 2, MOTOR_RETRY_TIME, MOTOR_RETRY_TIME * 1.5):
        body.tick(now)
    assert [call for call in mind.calls if call not in ("sense", "tick")] == ["failed: no timeout"]
    body.tick(MOTOR_RETRY_TIME * 2)
    assert mind.calls[-1] == "repaired"
    assert not motors.enabled


def test_what_is_proven_is_not_asked_each_cycle() -> None:
    asked: list[int] = []
    body, _, motors = machine(lambda: asked.append(1))
    for cycle in range(200):
        body.tick(0.02 * cycle)
    assert len(asked) == 1
    assert motors.asked == []


def test_after_a_failure_it_is_proven_anew() -> None:
    asked: list[int] = []
    body, mind, motors = machine(lambda: asked.append(1))
    mind.outputs = AHEAD
    body.tick(0.0)
    motors.broken["set"] = MotorError("no answer on the bus")
    body.tick(0.02)
    motors.broken.clear()
    body.tick(0.02 + MOTOR_RETRY_TIME)
    assert len(asked) == 2
    assert mind.calls[-1] == "repaired"


def test_a_stop_that_fails_is_tried_each_cycle_and_told_once() -> None:
    body, mind, motors = driving()
    motors.broken["disable"] = MotorError("bus is gone")
    mind.outputs = OFF
    for cycle in range(10):
        body.tick(0.02 * cycle)
    assert motors.enabled
    assert motors.asked.count("disable") >= 10
    assert mind.calls.count("failed: bus is gone") == 1
    del motors.broken["disable"]
    body.tick(0.2)
    assert not motors.enabled


def test_motors_are_tried_again_at_rest_and_reported_repaired() -> None:
    body, mind, motors = driving()
    motors.broken["set"] = MotorError("no answer")
    body.tick(0.0)
    body.tick(MOTOR_RETRY_TIME / 2)
    assert "repaired" not in mind.calls
    body.tick(MOTOR_RETRY_TIME)
    assert "repaired" not in mind.calls, "the fault is still there"
    del motors.broken["set"]
    body.tick(MOTOR_RETRY_TIME * 1.5)
    assert "repaired" not in mind.calls, "not asked again so soon"
    body.tick(MOTOR_RETRY_TIME * 2)
    assert mind.calls.count("repaired") == 1
    assert motors.outputs == (0.0, 0.0)
    assert not motors.enabled
    body.tick(MOTOR_RETRY_TIME * 4)
    assert mind.calls.count("repaired") == 1


def test_a_second_failure_after_repair_is_told_again() -> None:
    body, mind, motors = driving()
    for start in (0.0, 10.0):
        mind.outputs = AHEAD
        motors.broken["set"] = MotorError("no answer")
        body.tick(start)
        motors.broken.clear()
        body.tick(start + MOTOR_RETRY_TIME)
    assert mind.calls.count("failed: no answer") == 2
    assert mind.calls.count("repaired") == 2


# ---- the end ----


def test_close_is_neutral_then_disabled_then_let_go() -> None:
    body, _, motors = driving()
    body.close()
    assert motors.asked == ["set 0.0 0.0", "disable", "close"]
    body.close()
    assert len(motors.asked) == 3


def test_a_driver_that_is_never_neutral_again_still_loses_power() -> None:
    body, _, motors = driving()
    motors.broken["set"] = OSError("unplugged")
    body.close()
    assert motors.asked == ["set 0.0 0.0", "disable", "close"]
    assert motors.outputs == (0.0, 0.0)


@pytest.mark.parametrize("verb", ["disable", "close"])
def test_close_tries_every_step_and_says_what_failed(verb: str) -> None:
    body, _, motors = driving()
    motors.broken[verb] = OSError("unplugged")
    with pytest.raises(OSError, match="unplugged"):
        body.close()
    assert motors.asked == ["set 0.0 0.0", "disable", "close"]


def test_nothing_turns_after_close() -> None:
    body, mind, motors = driving()
    body.close()
    mind.outputs = mind.next = TURN
    body.receive(MESSAGE, 0.1)
    body.tick(0.2)
    body.observe([], 0.3)
    assert motors.outputs == (0.0, 0.0)
    assert not motors.enabled
    assert motors.asked[-1] == "close"


def test_shutdown_stops_the_motors_before_the_last_messages() -> None:
    body, mind, motors = driving()
    body.shutdown(1.0)
    assert motors.asked[-1] == "close"
    assert mind.calls == ["shutdown"]


def test_shutdown_speaks_even_where_the_motors_fail() -> None:
    body, mind, motors = driving()
    motors.broken["disable"] = MotorError("bus is gone")
    with pytest.raises(MotorError, match="bus is gone"):
        body.shutdown(1.0)
    assert mind.calls == ["shutdown"]


@each_row("fault", [ZeroDivisionError("bug"), SystemExit(3), KeyboardInterrupt()])
@each_row("verb", ["receive", "tick", "observe", "messages_to_send"])
def test_an_exception_stops_the_motors_before_it_goes_on(verb: str, fault: BaseException) -> None:
    body, mind, motors = driving()
    mind.fault = fault
    arguments: dict[str, tuple[object, ...]] = {
        "receive": (MESSAGE, 0.1),
        "tick": (0.1,),
        "observe": ([], 0.1),
        "messages_to_send": (),
    }
    with pytest.raises(type(fault)):
        getattr(body, verb)(*arguments[verb])
    assert motors.asked == ["set 0.0 0.0", "disable", "close"]


def test_a_driver_with_a_bug_is_stopped_like_any_other_fault() -> None:
    body, mind, motors = driving()
    motors.broken["set"] = ZeroDivisionError("in the driver")
    with pytest.raises(ZeroDivisionError) as caught:
        body.tick(0.1)
    assert motors.asked[-2:] == ["disable", "close"]
    assert not motors.enabled
    assert not hasattr(caught.value, "__notes__")
    assert mind.calls[-1] == "shutdown"


def test_a_fault_that_cannot_stop_the_motors_says_so() -> None:
    body, mind, motors = driving()
    mind.fault = ZeroDivisionError("bug")
    motors.broken["disable"] = OSError("bus is gone")
    with pytest.raises(ZeroDivisionError) as caught:
        body.tick(0.1)
    assert "bus is gone" in caught.value.__notes__[0]


def test_bad_outputs_never_reach_a_wheel() -> None:
    body, mind, motors = driving()
    mind.outputs = Outputs((float("nan"), 0.0), enabled=True)
    body.tick(0.1)
    assert motors.outputs == (0.0, 0.0)
    assert "failed: throttle nan is outside -1..1" in mind.calls
