"""The motor test: with our own rover behind it, first a wheel turns, then it stops, whatever ends the test."""

from __future__ import annotations

import pytest

from dialects import messages as m
from dialects.enums import Autopilot, Command
from groundstation.intents.base import Intent
from groundstation.intents.driving import EmergencyStop, Stop
from groundstation.intents.session import RenewLease, ReportKeyReleases, SetKeyGate
from groundstation.intents.setup import StopMotorTest, TurnMotor
from groundstation.intents.vehicle import Arm, Disarm
from groundstation.intents.watch import Watch
from groundstation.station.doctor.doctor_facts import find_motors
from groundstation.station.driving.motor_test import LONGEST
from groundstation.vehicles.readings.motor_outputs import build_stop, build_turn, is_turn, motors_of
from groundstation.views.doctor import DoctorRequest
from tests.fakes.rover import FakeArduPilot
from tests.groundstation.cockpits import Cockpit
from tests.test_stops import Drive
from vehicle.safety.states import SafetyState

GONE_WITHIN = 0.5
"""s for which a wheel may turn after the station is gone: the promise of docs/safety.md, not the program's constant."""
TURN = TurnMotor(system=1, motor=1, throttle=0.2)
WATCH = Watch((DoctorRequest(),))


class Bench(Drive):
    """Our station and our rover, disarmed; the Setup screen is shown. `pressed` repeats as a terminal does."""

    def __init__(self, *, exact: bool = True, loss: float = 0.0) -> None:
        super().__init__(loss=loss)
        self.pressed: TurnMotor | None = None
        self._press_due = 0.0
        self.tell(SetKeyGate(open=False, reason="another screen is open"), WATCH)
        if exact:
            self.tell(ReportKeyReleases())
        self.until(lambda: self.station.snapshot(self.world.now, 0).vehicle is not None)
        self.run(2.0)

    def _each(self, now: float) -> None:
        super()._each(now)
        if self.screen_lives and self.pressed is not None and now >= self._press_due:
            self._press_due = now + self.repeat
            self.station.handle_intent(self.pressed, now)

    @property
    def text(self) -> str:
        """What the screen says about the test."""
        view = self.station.feed.doctor.tester.view
        return view.text if view is not None else ""

    def turn(self, intent: TurnMotor = TURN) -> None:
        """Press the key, and wait until the wheel turns."""
        self.tell(intent)
        self.until(lambda: self.power > 0.1, within=0.5)
        assert self.rover.outputs.throttles[1] == 0.0, "one wheel only"

    def stands_within(self, seconds: float) -> None:
        """Check that the wheel stands by then, and stays."""
        assert self.power > 0.1, "the wheel must turn, or there is nothing to stop"
        self.until(lambda: self.power == 0.0, within=seconds)
        self.moved.clear()
        self.run(3.0)
        assert max(power for _, power in self.moved) == 0.0


def test_it_turns_while_the_key_is_held_and_stops_at_its_release() -> None:
    bench = Bench()
    bench.turn()
    bench.run(1.2)
    assert bench.power == pytest.approx(0.2), "renewed, although each request is for 0.5 s at most"
    bench.tell(StopMotorTest())
    bench.stands_within(0.05)


def test_it_turns_two_seconds_at_most() -> None:
    bench = Bench()
    bench.turn()
    start = bench.world.now
    bench.until(lambda: bench.power == 0.0, within=LONGEST + 0.1)
    assert bench.world.now - start > 1.8
    bench.tell(TurnMotor(system=1, motor=1, throttle=0.2, repeat=True))
    bench.run(1.0)
    assert bench.power == 0.0, "the same key, still held"


@pytest.mark.parametrize("intent", [
    Stop(), EmergencyStop(), Disarm(), Arm(held=0.0), Stop("the terminal window has lost the focus"),
    Watch(()), TurnMotor(system=1, motor=2, throttle=0.2),
], ids=lambda intent: type(intent).__name__)  # fmt: skip
def test_every_other_key_and_another_screen_stop_it(intent: Intent) -> None:
    bench = Bench()
    bench.turn()
    bench.tell(intent)
    bench.stands_within(0.1)


def test_a_screen_that_freezes_or_dies_stops_it() -> None:
    bench = Bench()
    bench.turn()
    bench.screen_lives = False
    bench.stands_within(0.5)
    assert "screen not responding" in bench.text


def test_killed_station_leaves_a_wheel_turning_for_half_a_second() -> None:
    bench = Bench()
    bench.turn()
    bench.run(0.6)
    bench.world.near.frozen = True  # as after kill -9: it sends nothing more
    bench.stands_within(GONE_WITHIN)


def test_a_cut_link_does_so_too() -> None:
    bench = Bench()
    bench.turn()
    bench.run(0.6)
    bench.world.cut()
    bench.stands_within(GONE_WITHIN)


def test_a_station_that_wakes_up_turns_nothing() -> None:
    bench = Bench()
    bench.turn()
    bench.world.near.frozen = True
    bench.stands_within(GONE_WITHIN)
    bench.world.near.frozen = False
    bench.moved.clear()
    bench.run(1.0)
    assert max(power for _, power in bench.moved) == 0.0


def test_with_timers_a_held_key_turns_it_and_a_pause_stops_it() -> None:
    bench = Bench(exact=False)
    bench.turn()
    bench.run(0.4)  # the repeat delay
    bench.pressed = TURN
    bench.run(1.0)
    assert bench.power == pytest.approx(0.2)
    bench.pressed = None
    bench.stands_within(0.3)


def test_with_timers_a_key_that_is_held_on_turns_no_second_time() -> None:
    bench = Bench(exact=False)
    bench.turn()
    bench.pressed = TURN
    bench.until(lambda: bench.power == 0.0, within=LONGEST + 0.1)
    bench.moved.clear()
    bench.run(3.0)
    assert max(power for _, power in bench.moved) == 0.0


def test_the_next_press_turns_it_again_at_once() -> None:
    bench = Bench()
    for _ in range(4):  # the rover takes equal requests within 3 s for repeats
        bench.turn()
        bench.tell(StopMotorTest())
        bench.until(lambda: bench.power == 0.0, within=0.1)
        bench.run(0.4)


def test_with_losses_it_stops_as_well() -> None:
    bench = Bench(loss=0.3)
    bench.tell(TURN)
    bench.until(lambda: bench.power > 0.1, within=1.0)
    bench.tell(StopMotorTest())
    bench.stands_within(GONE_WITHIN)


def test_not_while_armed() -> None:
    bench = Bench()
    bench.tell(Watch(()), SetKeyGate(open=True))
    bench.run(1.0)
    bench.tell(Arm(held=1.0))
    bench.until(lambda: bench.rover.state is SafetyState.ARMED)
    bench.run(1.5)
    bench.tell(WATCH, TURN)
    assert bench.text == "not turned: the vehicle is armed"
    assert not [message for _, message in bench.world.near.sent if is_turn(message)]


@pytest.mark.parametrize(("intent", "words"), [
    (TurnMotor(system=2, motor=1, throttle=0.1), "another vehicle was selected"),
    (TurnMotor(system=1, motor=3, throttle=0.1), "there is no motor 3"),
    (TurnMotor(system=1, motor=0, throttle=0.1), "there is no motor 0"),
    (TurnMotor(system=1, motor=1, throttle=0.31), "more than 30%"),
    (TurnMotor(system=1, motor=1, throttle=float("nan")), "more than 30%"),
])  # fmt: skip
def test_what_is_refused_is_not_sent(intent: TurnMotor, words: str) -> None:
    bench = Bench()
    bench.tell(intent)
    bench.run(0.5)
    assert words in bench.text
    assert not [message for _, message in bench.world.near.sent if is_turn(message)]


def test_the_vehicles_refusal_is_shown_and_ends_it() -> None:
    bench = Bench()
    bench.params.set("MOT_TEST_MAX", 10)
    bench.tell(TURN)
    bench.run(0.5)
    assert bench.text == "refused: DENIED: Motor test refused: more than 10 % (MOT_TEST_MAX)"
    assert len([message for _, message in bench.world.near.sent if is_turn(message)]) == 1


# ---- foreign vehicles ----


def motor_cockpit(withheld: str = "", seconds: float = 3.0) -> Cockpit:
    vehicle = FakeArduPilot()
    functions = {f"SERVO{channel}_FUNCTION": 0.0 for channel in range(1, 9)}
    vehicle.params |= {**functions, "SERVO1_FUNCTION": 73.0, "SERVO3_FUNCTION": 74.0}
    cockpit = Cockpit(vehicle)
    vehicle.params.withheld |= {withheld}
    cockpit.do(RenewLease(), ReportKeyReleases(), WATCH)
    cockpit.run(seconds)
    return cockpit


def test_ardupilot_gets_short_requests_and_a_stop() -> None:
    cockpit = motor_cockpit()
    cockpit.do(TurnMotor(system=1, motor=2, throttle=-0.1))
    cockpit.run(1.0)
    sent = cockpit.vehicle.commands(Command.DO_MOTOR_TEST)
    assert [(each.param1, each.param2, round(each.param3)) for each in sent] == [(4, 0, -10)] * len(sent)
    assert 4 <= len(sent) <= 5
    assert all(0 < each.param4 <= GONE_WITHIN for each in sent)
    cockpit.do(StopMotorTest())
    cockpit.run(1.0)
    stops = cockpit.vehicle.commands(Command.DO_MOTOR_TEST)[len(sent) :]
    assert [(each.param1, each.param3, each.param4) for each in stops] == [(4, 0, 0)] * 3


def test_motors_have_numbers_once_all_functions_are_read() -> None:
    cockpit = motor_cockpit(withheld="SERVO1_FUNCTION", seconds=1.5)
    contact = cockpit.station.fleet.get(1)
    assert contact is not None
    assert "SERVO3_FUNCTION" in contact.drive.params.values
    assert find_motors(contact) == (), "SERVO3 would be motor 1"
    cockpit.vehicle.params.withheld.clear()
    cockpit.run(2.0)
    assert [motor.name for motor in find_motors(contact)] == ["left wheel", "right wheel"]
    cockpit.do(TurnMotor(system=1, motor=2, throttle=0.1))
    cockpit.run(0.5)
    assert {each.param1 for each in cockpit.vehicle.commands(Command.DO_MOTOR_TEST)} == {4}


def test_a_function_that_is_never_answered_is_not_waited_for() -> None:
    cockpit = motor_cockpit(withheld="SERVO8_FUNCTION")
    cockpit.run(5.0)
    contact = cockpit.station.fleet.get(1)
    assert [motor.name for motor in find_motors(contact)] == ["left wheel", "right wheel"]


def test_ardupilot_arms_itself_for_a_test_which_does_not_end_it() -> None:
    cockpit = motor_cockpit()
    cockpit.do(TurnMotor(system=1, motor=1, throttle=0.1))
    cockpit.run(0.3)
    cockpit.vehicle.armed = True
    cockpit.vehicle.beat()
    cockpit.run(1.0)
    tester = cockpit.station.feed.doctor.tester
    assert tester.view is not None
    assert tester.view.turning
    cockpit.do(StopMotorTest())
    cockpit.do(TurnMotor(system=1, motor=1, throttle=0.1))
    assert not tester.view.turning, "still armed: it may be another one who has armed it"


def test_an_unanswered_request_is_not_repeated_after_the_release() -> None:
    cockpit = motor_cockpit()
    cockpit.vehicle.silent_on.add(Command.DO_MOTOR_TEST)
    cockpit.do(TurnMotor(system=1, motor=1, throttle=0.1))
    cockpit.run(0.1)
    cockpit.do(StopMotorTest())
    count = len([each for each in cockpit.vehicle.commands(Command.DO_MOTOR_TEST) if is_turn(each)])
    cockpit.run(5.0)
    assert len([each for each in cockpit.vehicle.commands(Command.DO_MOTOR_TEST) if is_turn(each)]) == count == 1


@pytest.mark.parametrize(("autopilot", "names"), [
    (Autopilot.PX4, ["motor 1", "motor 2", "servo 1"]),
    (Autopilot.ARDUPILOT, ["steering servo", "throttle servo"]),
    (Autopilot.GENERIC, ["left wheel", "right wheel"]),
])  # fmt: skip
def test_motors_of(autopilot: int, names: list[str]) -> None:
    info = m.RoverDriveInfo(1, 1, 1, 1, 450, 1, 0, 3, 0, 2)
    found = motors_of(autopilot, info, {1: 26.0, 3: 70.0, 5: 0.0}, rover_dialect=True)
    assert [motor.name for motor in found] == names
    for motor in found:
        for command, params in (build_turn(autopilot, motor, 0.1, 0.5), build_stop(autopilot, motor)):
            message = m.CommandLong(1, 1, command, 0, *params)
            assert is_turn(message) is (params == build_turn(autopilot, motor, 0.1, 0.5)[1])
    assert motors_of(Autopilot.GENERIC, info, {}, rover_dialect=False) == ()
