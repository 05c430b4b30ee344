"""Commands for relays and servos in virtual time: who is obeyed when, what makes them safe, what telemetry tells."""

from __future__ import annotations

import math

import pytest

from dialects import messages as m
from dialects.enums import Command, DriveType, Failsafe, Result
from dialects.modes import Mode
from tests.vehicle.bench import AHEAD, CYCLE, NEUTRAL, OTHER, Bench, Equipped, said
from vehicle.accessories.output import AccessorySpec, PulseRange
from vehicle.accessories.simulated import SimulatedAccessory
from vehicle.drive.mixer import MIXERS
from vehicle.safety.states import SafetyState

SET_RELAY, REPEAT_RELAY = Command.DO_SET_RELAY, Command.DO_REPEAT_RELAY
SET_SERVO, REPEAT_SERVO = Command.DO_SET_SERVO, Command.DO_REPEAT_SERVO
STOP, MOTORS_OFF = Command.DO_SET_SAFETY_SWITCH_STATE, Command.COMPONENT_ARM_DISARM


def on(bench: Bench, number: int) -> bool:
    return bool(bench.rack.values("relay")[number])


def pulse(bench: Bench, number: int = 9) -> int:
    return bench.rack.values("servo")[number]


def switch(bench: Bench, number: int, state: int = 1) -> None:
    assert bench.command(SET_RELAY, number, state) is Result.ACCEPTED, bench.texts
    bench.wait(CYCLE)
    assert on(bench, number) is bool(state)


class TestObeyed:
    def test_a_relay_goes_on_and_off_without_arming(self) -> None:
        bench = Equipped()
        switch(bench, 0)
        assert not on(bench, 1)
        switch(bench, 0, 0)

    def test_a_servo_goes_there_and_stays(self) -> None:
        bench = Equipped()
        assert pulse(bench) == 0
        assert bench.command(SET_SERVO, 9, 1700) is Result.ACCEPTED
        bench.wait(10.0)
        assert pulse(bench) == 1700

    def test_a_repeat_answers_at_once_and_goes_on_beside_the_drive(self) -> None:
        bench = Equipped()
        bench.drive()
        assert bench.command(REPEAT_RELAY, 0, 2, 0.5) is Result.ACCEPTED
        seen = []
        for _ in range(30):
            bench.wait(0.1, AHEAD)
            seen.append(on(bench, 0))
        assert seen == [True] * 5 + [False] * 5 + [True] * 5 + [False] * 15
        assert bench.turning

    def test_a_newer_command_ends_a_repeat_of_its_own_output_only(self) -> None:
        bench = Equipped()
        bench.command(REPEAT_RELAY, 0, 100, 0.5)
        bench.command(REPEAT_SERVO, 9, 1800, 100, 0.5)
        bench.wait(0.2)
        assert (on(bench, 0), pulse(bench)) == (True, 1800)
        switch(bench, 0, 1)
        bench.wait(0.5)
        assert (on(bench, 0), pulse(bench)) == (True, 1500)
        bench.wait(0.5)
        assert (on(bench, 0), pulse(bench)) == (True, 1800)

    def test_a_repeat_that_is_said_again_does_not_begin_anew(self) -> None:
        """Its answer was lost: the relay would end in the wrong state, or go there once too often."""
        bench = Equipped()
        count = 0
        bench.command(REPEAT_RELAY, 0, 1, 0.3)
        for _ in range(14):
            before = on(bench, 0)
            bench.wait(0.1)
            count += on(bench, 0) != before
            assert bench.command(REPEAT_RELAY, 0, 1, 0.3) is Result.ACCEPTED
        assert (count, on(bench, 0)) == (2, False)
        bench.wait(4.0)
        bench.command(REPEAT_RELAY, 0, 1, 0.3)
        bench.wait(0.1)
        assert on(bench, 0)  # later it is a new wish

    def test_the_same_repeat_after_another_command_is_a_new_one(self) -> None:
        bench = Equipped()
        bench.command(REPEAT_RELAY, 0, 9, 0.3)
        switch(bench, 0, 0)
        bench.command(REPEAT_RELAY, 0, 9, 0.3)
        bench.wait(0.1)
        assert on(bench, 0)

    def test_too_fast_a_repeat_is_made_slower(self) -> None:
        bench = Equipped()
        bench.command(REPEAT_RELAY, 0, 1, 0)
        bench.wait(0.06)
        assert on(bench, 0)
        bench.wait(0.1)
        assert not on(bench, 0)


class TestRefused:
    @pytest.mark.parametrize(
        ("command", "params", "words"),
        [
            (SET_RELAY, (7, 1), "DO_SET_RELAY refused: there is no relay 7"),
            (SET_RELAY, (0, 2), "DO_SET_RELAY refused: relay 0: 2 is neither 0 nor 1"),
            (SET_SERVO, (10, 1500), "DO_SET_SERVO refused: there is no servo 10"),
            (SET_SERVO, (3, 1500), "DO_SET_SERVO refused: servo 3 is a motor"),
            (SET_SERVO, (9, 2500), "DO_SET_SERVO refused: servo 9: 2500 us is not 1100 to 1900"),
            (REPEAT_SERVO, (9, 1500, 0, 1), "refused: servo 9: times 0 is not a whole number from 1 to 1000"),
            (REPEAT_RELAY, (0, 1, -1), "refused: relay 0: period -1 s is not 0 to 3600"),
        ],
    )
    def test_what_can_never_be_is_denied_in_words(self, command: int, params: tuple[float, ...], words: str) -> None:
        bench = Equipped()
        assert bench.command(command, *params) is Result.DENIED
        bench.wait(1.0)
        assert said(bench, words)
        assert (bench.rack.values("relay"), bench.rack.values("servo")) == ({0: 0, 1: 0, 2: 0}, {9: 0})

    def test_only_the_driver_in_control_may(self) -> None:
        bench = Equipped()
        bench.arm()
        assert bench.command(SET_RELAY, 0, 1, system=OTHER) is Result.FAILED
        bench.wait(1.0)
        assert not on(bench, 0)


class TestSafe:
    def test_an_emergency_stop_makes_safe_all_but_those_that_stay(self) -> None:
        bench = Equipped()
        bench.drive()
        for number in (0, 1, 2):
            switch(bench, number)
        bench.command(SET_SERVO, 9, 1700)
        bench.command(REPEAT_RELAY, 0, 100, 0.1)
        bench.wait(0.05)
        bench.command(STOP, 0, system=OTHER)
        bench.wait(CYCLE)
        assert bench.rover.state is SafetyState.ESTOP
        assert (bench.rack.values("relay"), pulse(bench)) == ({0: 0, 1: 1, 2: 0}, 0)
        bench.wait(2.0)
        assert said(bench, "Relay 0: off (emergency stop)")
        assert said(bench, "Servo 9: no pulses (emergency stop)")
        assert bench.command(SET_RELAY, 0, 1) is Result.FAILED
        assert bench.command(STOP, 1) is Result.ACCEPTED
        bench.wait(1.0)
        assert not on(bench, 0)  # nothing comes back by itself
        switch(bench, 0)

    def test_the_same_repeat_after_an_emergency_stop_is_a_new_wish(self) -> None:
        bench = Equipped()
        bench.command(REPEAT_RELAY, 0, 100, 0.5)
        bench.wait(CYCLE)
        bench.command(STOP, 0)
        bench.wait(CYCLE)
        bench.command(STOP, 1)
        assert bench.command(REPEAT_RELAY, 0, 100, 0.5) is Result.ACCEPTED
        bench.wait(CYCLE)
        assert on(bench, 0)

    def test_disarming_switches_off_only_what_says_so(self) -> None:
        bench = Equipped()
        assert bench.command(SET_RELAY, 2, 1) is Result.FAILED
        bench.arm()
        for number in (0, 2):
            switch(bench, number)
        bench.command(MOTORS_OFF, 0, system=OTHER)
        bench.wait(CYCLE)
        assert (on(bench, 0), on(bench, 2)) == (True, False)
        bench.arm()
        bench.wait(1.0)
        assert not on(bench, 2)

    def test_a_failsafe_switches_off_what_needs_an_armed_vehicle(self) -> None:
        bench = Equipped()
        bench.drive()
        for number in (0, 2):
            switch(bench, number)
        bench.wait(0.2, AHEAD)
        assert on(bench, 2)
        bench.wait(1.0)  # nothing comes of the driver
        assert bench.rover._safety.failsafes.active & Failsafe.MANUAL_LOSS
        assert (on(bench, 0), on(bench, 2)) == (True, False)
        assert bench.command(SET_RELAY, 2, 1) is Result.FAILED
        bench.wait(3.0)
        assert bench.mode is Mode.HOLD
        assert bench.command(SET_RELAY, 2, 1) is Result.FAILED  # until the driver chooses a mode
        bench.set_mode(Mode.MANUAL)
        bench.wait(0.2, NEUTRAL)
        switch(bench, 2)

    def test_the_end_of_the_rover_asks_for_nothing_more(self) -> None:
        bench = Equipped()
        bench.command(REPEAT_RELAY, 0, 100, 0.1)
        bench.wait(CYCLE)
        bench.rover.shutdown(bench.now)
        before = bench.rack.values("relay")
        bench.wait(1.0)
        assert bench.rack.values("relay") == before
        bench.rack.close()
        assert bench.rack.values("relay") == {}


class TestTold:
    def test_relays_and_servos_are_sent_at_once_and_on_request(self) -> None:
        bench = Equipped()
        bench.wait(3.0)
        assert (bench.newest(m.RelayStatus).on, bench.newest(m.RelayStatus).present) == (0, 0b111)
        switch(bench, 1)
        bench.command(SET_SERVO, 9, 1700)
        bench.wait(2 * CYCLE)
        assert bench.newest(m.RelayStatus).on == 0b10
        bench.wait(1.0)
        servos = bench.newest(m.ServoOutputRaw)
        assert (servos.servo1_raw, servos.servo3_raw, servos.servo9_raw, servos.servo10_raw) == (1500, 1500, 1700, 0)

    def test_its_rate_can_be_set(self) -> None:
        bench = Equipped()
        bench.wait(1.0)
        assert bench.command(Command.SET_MESSAGE_INTERVAL, m.RelayStatus.id, 100_000) is Result.ACCEPTED
        before = len(bench.all(m.RelayStatus))
        bench.wait(5.0)
        assert len(bench.all(m.RelayStatus)) - before == pytest.approx(50, abs=3)

    def test_without_relays_there_is_nothing_to_tell(self) -> None:
        bench = Bench()
        bench.wait(5.0)
        assert bench.all(m.RelayStatus) == []

    def test_a_fault_is_told_once_and_its_end_too(self) -> None:
        broken = True

        class Weak(SimulatedAccessory):
            def set(self, value: int) -> None:
                if broken:
                    raise OSError("no answer")
                super().set(value)

        class WithFault(Bench):
            outputs = (AccessorySpec("servo", 9, Weak, pulses=PulseRange(1000, 1500, 2000)),)

        bench = WithFault()
        assert bench.command(SET_SERVO, 9, 1600) is Result.ACCEPTED
        bench.wait(5.0)
        assert bench.texts.count("Servo 9: no answer") == 1
        assert bench.command(SET_SERVO, 9, 1700) is Result.FAILED
        broken = False
        bench.wait(2.0)
        assert said(bench, "Servo 9 works again")
        assert pulse(bench) == 1700
        assert bench.command(SET_SERVO, 9, 1800) is Result.ACCEPTED

    def test_one_that_did_not_open_is_told_and_the_rover_drives(self) -> None:
        def absent(value: int) -> SimulatedAccessory:
            raise OSError("no such bus")

        class Without(Bench):
            outputs = (AccessorySpec("relay", 0, absent),)

        bench = Without()
        bench.drive()
        assert said(bench, "Relay 0: no such bus")
        assert bench.command(SET_RELAY, 0, 1) is Result.FAILED


NUMBERS = (-1, 0, 1, 2, 3, 4, 5, 9, 16, 17, 1.5, math.nan, math.inf)


@pytest.mark.parametrize("kind", MIXERS)
@pytest.mark.parametrize("state", ["disarmed", "armed", "driving"])
def test_no_accessory_command_ever_moves_a_motor(kind: DriveType, state: str) -> None:
    """Even where somebody has given a servo the number of a motor."""

    class Clashing(Bench):
        outputs = tuple(
            AccessorySpec("servo", number, SimulatedAccessory, pulses=PulseRange(500, 1500, 2500))
            for number in range(1, 17)
        )

    quiet, asked = Clashing(DRIVE_TYPE=kind), Clashing(DRIVE_TYPE=kind)
    motors = {int(each) for each in asked.rover._drive.mixer.servos}
    for bench in (quiet, asked):
        if state != "disarmed":
            bench.drive() if state == "driving" else bench.arm()
    axes = AHEAD if state == "driving" else NEUTRAL
    for command in (SET_SERVO, REPEAT_SERVO, SET_RELAY, REPEAT_RELAY):
        for number in NUMBERS:
            for value in (500, 1500, 2500, 1, 0):
                result = asked.command(command, number, value, 1, 0.1)
                if command in (SET_SERVO, REPEAT_SERVO) and number in motors:
                    assert result is Result.DENIED
            for bench in (quiet, asked):
                bench.wait(CYCLE, axes, period=CYCLE)
            assert asked.rover.outputs == quiet.rover.outputs
    assert asked.turning is (state == "driving")
    assert {number for number, value in asked.rack.values("servo").items() if value} == {1, 2, 3, 4, 5, 9, 16} - motors
