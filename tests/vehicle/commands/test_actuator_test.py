"""DO_MOTOR_TEST and ACTUATOR_TEST: bad input 56, what they turn, and all that ends it."""

from __future__ import annotations

import math

import pytest

from dialects import messages as m
from dialects.axes import Axes
from dialects.enums import Command, Result
from dialects.modes import Mode
from link.core import Peer, Received
from tests.rows import each_row
from tests.vehicle.bench import AHEAD, CYCLE, DRIVER, NEUTRAL, OTHER, Bench, said
from vehicle.drive.gate import Outputs

MOTOR, ACTUATOR = Command.DO_MOTOR_TEST, Command.ACTUATOR_TEST
NAN = math.nan
ZERO = Outputs((0.0, 0.0), enabled=False)


def motor(instance: float = 1, percent: float = 20, seconds: float = 3, kind: float = 0, count: float = 0) -> tuple[
        int, float, float, float, float, float]:  # fmt: skip
    return MOTOR, instance, kind, percent, seconds, count


def actuator(value: float = 0.2, seconds: float = 3, function: float = 1) -> tuple[int, float, float, float, float,
                                                                                   float]:  # fmt: skip
    return ACTUATOR, value, seconds, 0, 0, function


def beating(bench: Bench, seconds: float, system: int = DRIVER) -> None:
    """Time passes, with the heartbeats of a ground station and nothing else from it."""
    whole = int(seconds)
    for _ in range(whole):
        bench.heartbeat(system)
        bench.wait(1.0)
    bench.heartbeat(system)
    bench.wait(seconds - whole)


def turning(words: tuple[float, ...] | None = None) -> Bench:
    """The danger: a wheel turns."""
    bench = Bench()
    bench.heartbeat()
    assert bench.command(*(words or motor())) is Result.ACCEPTED
    bench.wait(0.3)
    assert bench.throttles[0]
    return bench


@pytest.mark.parametrize(
    ("words", "throttles"),
    [
        (motor(1, 20), (0.2, 0.0)),
        (motor(2, -30), (0.0, -0.3)),
        (motor(1, 10, count=1), (0.1, 0.0)),
        (actuator(0.3, 1, 2), (0.0, 0.3)),
        (actuator(-0.25, 1, 1), (-0.25, 0.0)),
    ],
)
def test_one_wheel_turns_as_asked(words: tuple[float, ...], throttles: tuple[float, ...]) -> None:
    bench = Bench()
    assert bench.command(*words) is Result.ACCEPTED  # type: ignore[arg-type]
    bench.wait(0.3)
    assert bench.rover.outputs == Outputs(pytest.approx(throttles), enabled=True)  # type: ignore[arg-type]
    assert not bench.armed


def test_it_turns_however_long_the_vehicle_was_disarmed() -> None:
    bench = Bench(DISARM_DELAY=5)
    beating(bench, 8)
    assert bench.command(*motor()) is Result.ACCEPTED
    bench.wait(0.3)
    assert bench.turning


def test_the_driver_reads_which_and_how_it_ended() -> None:
    bench = Bench()
    bench.command(*motor(2, -20, 0.5))
    bench.wait(1.0)
    assert bench.texts[-2:] == [f"Motor test: right at -20% for 0.5 s, by GCS {DRIVER}", "Motor test over: time is up"]


def test_a_car_steers_by_its_second_motor() -> None:
    bench = Bench(DRIVE_TYPE=2)
    assert bench.command(*motor(2, 30)) is Result.ACCEPTED
    bench.wait(0.3)
    assert bench.throttles == pytest.approx((0.0, 0.3))
    assert bench.command(*motor(3)) is Result.DENIED


@pytest.mark.parametrize("seconds", [0.1, 1.0, 3.0])
def test_it_ends_with_its_time(seconds: float) -> None:
    bench = Bench()
    bench.command(*motor(1, 20, seconds))
    beating(bench, seconds - CYCLE)
    assert bench.turning
    bench.wait(2 * CYCLE)
    assert bench.rover.outputs == ZERO


STOPS = {
    "disarm": (Command.COMPONENT_ARM_DISARM, 0),
    "switch to safe": (Command.DO_SET_SAFETY_SWITCH_STATE, 0),
    "termination": (Command.DO_FLIGHTTERMINATION, 1),
    "HOLD": (Command.DO_SET_MODE, 1, Mode.HOLD),
    "pause": (Command.DO_PAUSE_CONTINUE, 0),
}


@pytest.mark.parametrize("stop", STOPS.values(), ids=STOPS)
@pytest.mark.parametrize(("system", "introduced"), [(DRIVER, True), (OTHER, False)])
def test_every_command_that_stops_ends_it_before_its_answer(
    stop: tuple[int, ...], system: int, introduced: bool
) -> None:
    bench = turning()
    assert bench.command(*stop, system=system, introduced=introduced) is Result.ACCEPTED
    assert bench.rover.outputs == ZERO
    beating(bench, 1.0)
    assert bench.rover.outputs == ZERO


@pytest.mark.parametrize("stop", STOPS.values(), ids=STOPS)
def test_stops_end_it_in_a_mode_that_drives_by_itself(stop: tuple[int, ...]) -> None:
    bench = Bench()
    assert bench.set_mode(Mode.GUIDED) is Result.ACCEPTED
    bench.command(*motor())
    bench.wait(0.3)
    assert bench.turning
    bench.command(*stop, system=OTHER)
    assert bench.rover.outputs == ZERO


@pytest.mark.parametrize("command", [Command.COMPONENT_ARM_DISARM, Command.DO_SET_SAFETY_SWITCH_STATE])
def test_a_stop_for_all_vehicles_ends_it(command: int) -> None:
    bench = turning()
    bench.command(command, 0, target=0)
    assert bench.rover.outputs == ZERO


def test_the_old_set_mode_ends_it() -> None:
    bench = turning()
    bench.say(m.SetMode(1, 1, Mode.HOLD), OTHER)
    assert bench.rover.outputs == ZERO


def test_arming_ends_it_and_nothing_of_it_goes_on() -> None:
    bench = turning()
    assert bench.arm() is Result.ACCEPTED
    assert bench.throttles == (0.0, 0.0)
    bench.wait(0.5, NEUTRAL)
    assert bench.throttles == (0.0, 0.0)
    bench.command(Command.COMPONENT_ARM_DISARM, 0)
    beating(bench, 0.5)
    assert bench.rover.outputs == ZERO


def test_a_motor_fault_ends_it_and_forbids_the_next() -> None:
    bench = turning()
    bench.rover.motor_failed("broken", bench.now)
    assert bench.rover.outputs == ZERO
    assert bench.command(*motor()) is Result.FAILED
    assert said(bench, "DO_MOTOR_TEST refused: vehicle is in state fault")
    bench.rover.motor_repaired(bench.now)
    beating(bench, 0.5)
    assert bench.rover.outputs == ZERO


def test_the_end_of_the_program_ends_it() -> None:
    bench = turning()
    bench.rover.shutdown(bench.now)
    assert bench.rover.outputs == ZERO


@pytest.mark.parametrize("gap", [0.12, 0.3, 1.0])
def test_a_late_control_cycle_ends_it(gap: float) -> None:
    bench = turning()
    bench.freeze(gap)
    bench.cycle()
    assert bench.rover.outputs == ZERO
    assert said(bench, "Motor test over: control loop was late")
    beating(bench, 1.0)
    assert bench.rover.outputs == ZERO


def test_a_message_that_is_handled_late_ends_it() -> None:
    bench = turning()
    bench.freeze(0.12)
    bench.heartbeat()
    bench.say(m.SetMode(2, 1, Mode.MANUAL))  # not for us, but what may move us is judged again
    bench.stick(AHEAD)
    assert bench.rover.outputs == ZERO


def test_heartbeats_keep_it_and_silence_ends_it() -> None:
    bench = turning(motor(seconds=3))
    bench.wait(1.1)
    assert bench.turning
    bench.wait(0.15)
    assert bench.rover.outputs == ZERO
    assert said(bench, f"Motor test over: GCS {DRIVER} is silent")
    bench.heartbeat()
    bench.wait(0.5)
    assert bench.rover.outputs == ZERO


@pytest.mark.parametrize("address", ["another link", f"gcs {OTHER}"])
def test_somebody_elses_frames_do_not_keep_it(address: str) -> None:
    bench = turning()
    for _ in range(20):
        bench.heartbeat(OTHER)
        bench.say(m.Heartbeat(6, 8, 0, 0, 4, 3), DRIVER, address=address)
        bench.wait(0.1)
    assert bench.rover.outputs == ZERO


def test_a_stick_does_not_move_it_meanwhile() -> None:
    bench = turning()
    bench.wait(0.3, NEUTRAL)
    bench.wait(0.5, Axes(throttle=1.0))
    assert bench.throttles == pytest.approx((0.2, 0.0))


BAD = {
    "1e9 s": motor(seconds=1e9), "-100 s": motor(seconds=-100), "NaN s": motor(seconds=NAN),
    "inf s": motor(seconds=math.inf), "0 s": motor(seconds=0), "3.01 s": motor(seconds=3.01),
    "300 %": motor(percent=300), "-31 %": motor(percent=-31), "NaN %": motor(percent=NAN),
    "inf %": motor(percent=math.inf), "motor 0": motor(0), "motor 3": motor(3), "motor NaN": motor(NAN),
    "motor 1.5": motor(1.5), "motor inf": motor(math.inf), "pulses": motor(1, 1600, kind=1),
    "stick": motor(kind=2),
    "kind NaN": motor(kind=NAN), "two motors": motor(count=2), "count NaN": motor(count=NAN),
    "value 3": actuator(3), "value 0.31": actuator(0.31), "value inf": actuator(math.inf),
    "4 s": actuator(seconds=4), "-1 s": actuator(seconds=-1), "time NaN": actuator(seconds=NAN),
    "no function": actuator(function=0), "servo 1": actuator(function=33), "function NaN": actuator(function=NAN),
}  # fmt: skip


class TestRefusals:
    @each_row("words", BAD.values())
    def test_56_what_is_too_much_is_denied(self, words: tuple[int, float, float, float, float, float]) -> None:
        bench = Bench()
        assert bench.command(*words) is Result.DENIED
        bench.wait(0.3)
        assert bench.rover.outputs == ZERO

    def test_the_largest_is_a_parameter(self) -> None:
        bench = Bench(MOT_TEST_MAX=10)
        assert bench.command(*motor(percent=11)) is Result.DENIED
        assert said(bench, "Motor test refused: more than 10 % (MOT_TEST_MAX)")
        assert bench.command(*motor(percent=10)) is Result.ACCEPTED
        assert Bench(MOT_TEST_MAX=0).command(*actuator(0.01)) is Result.DENIED

    def test_three_tenths_as_a_float_of_the_wire(self) -> None:
        bench = Bench()
        assert bench.command(*actuator(0.30000001192092896)) is Result.ACCEPTED
        bench.wait(0.3)
        assert bench.turning

    @pytest.mark.parametrize("words", [motor(), actuator(), motor(percent=NAN), actuator(NAN)])
    def test_while_armed_it_is_rejected_for_now(self, words: tuple[int, float, float, float, float, float]) -> None:
        bench = Bench()
        bench.drive()
        assert bench.command(*words) is Result.TEMPORARILY_REJECTED
        bench.wait(0.1, AHEAD)
        assert bench.throttles == (1.0, 1.0)

    def test_during_an_emergency_stop_it_fails(self) -> None:
        bench = Bench()
        bench.command(Command.DO_SET_SAFETY_SWITCH_STATE, 0)
        assert bench.command(*motor()) is Result.FAILED
        assert bench.command(*actuator()) is Result.FAILED
        bench.wait(0.3)
        assert bench.rover.outputs == ZERO
        assert said(bench, "DO_MOTOR_TEST refused: vehicle is in state estop")

    def test_only_who_is_in_control_or_known_may(self) -> None:
        bench = Bench()
        assert bench.command(*motor(), introduced=False) is Result.FAILED
        bench.arm()
        bench.command(Command.COMPONENT_ARM_DISARM, 0)
        assert bench.command(*motor(), system=OTHER) is Result.FAILED
        assert bench.command(*motor(), target=0) is None
        bench.wait(0.3)
        assert bench.rover.outputs == ZERO
        assert bench.command(*motor()) is Result.ACCEPTED

    def test_another_motor_or_another_station_waits(self) -> None:
        bench = turning()
        assert bench.command(*motor(2)) is Result.TEMPORARILY_REJECTED
        assert bench.command(*motor(1), system=OTHER) is Result.TEMPORARILY_REJECTED
        assert bench.throttles == pytest.approx((0.2, 0.0))
        beating(bench, 3.0)
        assert bench.command(*motor(2)) is Result.ACCEPTED
        bench.wait(0.3)
        assert bench.throttles == pytest.approx((0.0, 0.2))


class TestRepeats:
    def test_slider_goes_on_with_each_request_and_stops_with_last(self) -> None:
        bench = Bench()
        for step in range(40):
            assert bench.command(*actuator(0.1 + 0.005 * (step % 10), 0.5)) is Result.ACCEPTED
            bench.wait(0.1)
            assert bench.throttles[0] >= 0.1 or step == 0
        assert sum("Motor test" in text for text in bench.texts) == 1
        bench.wait(0.42)
        assert bench.rover.outputs == ZERO

    @pytest.mark.parametrize("words", [actuator(NAN, 0), actuator(0.2, 0), actuator(NAN, 1)])
    def test_nan_and_no_time_stop_as_the_specification_says(
        self, words: tuple[int, float, float, float, float, float]
    ) -> None:
        bench = turning()
        assert bench.command(*words) is Result.ACCEPTED
        assert bench.rover.outputs == ZERO
        assert bench.command(*words) is Result.ACCEPTED
        bench.wait(0.3)
        assert bench.rover.outputs == ZERO

    def test_a_repeat_after_the_end_does_not_turn_the_wheel_again(self) -> None:
        """Its answer was lost: the client repeats."""
        bench = turning(motor(seconds=0.4))
        bench.wait(0.3)
        assert bench.rover.outputs == ZERO
        assert bench.command(*motor(seconds=0.4)) is Result.ACCEPTED
        bench.wait(0.3)
        assert bench.rover.outputs == ZERO
        assert said(bench, "Motor test: repeated too soon, wait 3 s")
        bench.wait(3.0)
        assert bench.command(*motor(seconds=0.4)) is Result.ACCEPTED
        bench.wait(0.3)
        assert bench.turning

    def test_a_repeat_after_a_stop_does_not_turn_the_wheel_again(self) -> None:
        bench = turning()
        bench.command(Command.DO_SET_SAFETY_SWITCH_STATE, 0)
        bench.command(Command.DO_SET_SAFETY_SWITCH_STATE, 1)
        assert bench.command(*motor()) is Result.ACCEPTED
        beating(bench, 1.0)
        assert bench.rover.outputs == ZERO

    def test_another_wish_after_the_end_is_a_new_one(self) -> None:
        bench = turning(motor(seconds=0.4))
        bench.wait(0.3)
        assert bench.command(*motor(2, seconds=0.4)) is Result.ACCEPTED
        bench.wait(0.3)
        assert bench.throttles == pytest.approx((0.0, 0.2))


def test_command_int_works_alike() -> None:
    bench = Bench()
    bench.say(m.CommandInt(1, 1, 0, ACTUATOR, 0, 0, 0.2, 1.0, 0, 0, 2, 0, 0))
    assert bench.newest(m.CommandAck).result == Result.ACCEPTED
    bench.wait(0.3)
    assert bench.throttles == pytest.approx((0.0, 0.2))


def test_the_peer_is_the_askers() -> None:
    """Who shares the asker's system id on another link is somebody else."""
    bench = turning()
    for _ in range(20):
        beat = m.Heartbeat(6, 8, 0, 0, 4, 3)
        bench.rover.receive(Received(beat, DRIVER, 190, 1, Peer(1, f"gcs {DRIVER}"), introduced=True), bench.now)
        bench.wait(0.1)
    assert bench.rover.outputs == ZERO
