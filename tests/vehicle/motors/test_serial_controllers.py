from __future__ import annotations

import json
import signal
import subprocess
import sys
import termios
import threading
import time
from collections.abc import Callable, Iterator, Sequence
from functools import cached_property
from typing import Any

import pytest

from dialects.enums import Command, Result
from link.core import Received
from tests.vehicle.bench import CYCLE, said
from tests.vehicle.bench import Bench as RoverBench
from tests.vehicle.motors.contract import Bench, MotorsContract
from tests.vehicle.motors.controllers import RoboClaw, Sabertooth
from tests.vehicle.motors.pty_controller import OnPty, recorded
from tests.waits import Waits
from vehicle.control_loop import ControlLoop
from vehicle.motors import MotorError, Motors, MotorSettingsError, arming_check
from vehicle.motors.drivers import open_motors, safe_stop
from vehicle.motors.roboclaw import RoboClawMotors, RoboClawSettings
from vehicle.motors.sabertooth import SabertoothMotors, SabertoothSettings
from vehicle.motors.serial_controller import SerialController
from vehicle.sensors import NoSensors

MARGIN = 0.25
"""s more than its timeout that a controller may take here, and what the machine makes it wait: others work on it."""

KINDS: dict[str, tuple[Callable[[], Any], dict[str, Any], float]] = {
    "roboclaw": (RoboClaw, {"timeout": 0.5, "reply_time": 0.05}, 1 / 32767),
    "sabertooth": (Sabertooth, {"timeout": 0.5, "timeout_proven": True}, 1 / 127),
}
"""Driver -> controller, settings beside the port, how coarse it is."""


class InMachine(RoverBench):
    """The real rover above a driver; the time of both is the test's, that of the wire is real."""

    def __init__(self, motors: Motors) -> None:
        self._motors = motors
        super().__init__()

    @cached_property
    def machine(self) -> ControlLoop:
        return ControlLoop(self.rover, self._motors, NoSensors(), prove=arming_check(self._motors))

    def _receive(self, received: Received) -> None:
        self.machine.receive(received, self.now)

    def _tick(self) -> None:
        self.machine.tick(self.now)


class SerialContract(MotorsContract):
    """The contract, and silence: the controller stops by itself."""

    kind: str

    @pytest.fixture
    def line(self) -> Iterator[OnPty]:
        with OnPty(KINDS[self.kind][0]()) as line:
            yield line

    @pytest.fixture
    def bench(self, line: OnPty) -> Bench:
        _, settings, tolerance = KINDS[self.kind]
        motors: Any = open_motors(self.kind, {"port": line.path, **settings})
        frames = recorded(motors.port)
        return Bench(motors, lambda: line.outputs_after(frames), lambda: motors.enabled, tolerance)

    def test_stops_on_silence(self, bench: Bench, line: OnPty) -> None:
        waits = Waits()
        self.drive(bench)
        took = line.until(bench_neutral(line))
        assert took < 0.5 + MARGIN + waits.total()

    def test_goes_on_while_it_is_written_to(self, bench: Bench, line: OnPty) -> None:
        self.drive(bench)
        pause, began = threading.Event(), time.monotonic()
        written = began
        while time.monotonic() - began < 0.8:
            bench.motors.set(self.ahead(bench))
            written, gap = time.monotonic(), time.monotonic() - written
            machine_paused = gap > 0.2  # longer than ten cycles
            turns = any(line.controller.outputs)
            assert turns or machine_paused, "it stopped by its timeout in the middle of driving"
            pause.wait(0.02)

    def test_killed_with_9_the_controller_stops_and_safe_stop_confirms(self, line: OnPty) -> None:
        settings = {"port": line.path, **KINDS[self.kind][1]}
        with Driving(self.kind, settings) as process:
            line.until(lambda: line.controller.outputs == pytest.approx([0.5, -0.5], abs=0.01))
            waits = Waits()
            process.send_signal(signal.SIGKILL)
            assert process.wait() == -signal.SIGKILL
            took = line.until(bench_neutral(line))
        assert took < 0.5 + MARGIN + waits.total()
        assert safe_stop(self.kind, settings) == []
        assert line.controller.outputs == [0.0, 0.0]

    def test_safe_stop_stops_wheels_that_nothing_else_would_stop(self, line: OnPty) -> None:
        """A controller whose timeout is off: the killed process had a fault, or it is an old one."""
        settings = {"port": line.path, **KINDS[self.kind][1]}
        killed: Any = open_motors(self.kind, settings)
        killed.enable()
        killed.set((0.5, -0.5))
        line.until(lambda: any(line.controller.outputs))
        line.controller.timeout = 0.0
        killed.port.close()
        assert safe_stop(self.kind, settings) == []
        line.until(bench_neutral(line))

    def test_an_unplugged_port_is_an_error_and_then_found_again(self, bench: Bench, line: OnPty) -> None:
        motors: Any = bench.motors
        self.drive(bench)
        motors.port.close()  # as it closes itself at the first fault
        motors.port.path = "/dev/nowhere"
        assert "not open" in fault_of(motors, calls=3)
        with pytest.raises(MotorError, match="nowhere"):
            motors.disable()
        motors.port.path = line.path
        motors.disable()
        self.drive(bench)

    def test_a_second_process_cannot_have_the_port(self, bench: Bench, line: OnPty) -> None:
        with pytest.raises(MotorError, match="another program uses /dev/"):
            open_motors(self.kind, {"port": line.path, **KINDS[self.kind][1]})

    def test_a_line_that_nobody_reads_never_blocks(self, bench: Bench, line: OnPty) -> None:
        self.drive(bench)
        line.deaf.set()
        slowest = Slowest(bench.motors)
        assert fault_of(slowest, calls=100_000)
        assert slowest.call < 5.0  # one that blocks does so for ever; the machine is shared


def bench_neutral(line: OnPty) -> Callable[[], bool]:
    return lambda: line.controller.outputs == [0.0, 0.0]


def fault_of(motors: Motors | Slowest, calls: int, pause: float = 0.0) -> str:
    """What `set` says at last; it may put up with some failures."""
    never = threading.Event()
    for _ in range(calls):
        try:
            motors.set((0.5, 0.5))
        except MotorError as error:
            return str(error)
        never.wait(pause)
    raise AssertionError("it never failed")


class Slowest:
    """How long the slowest `set` took."""

    def __init__(self, motors: Motors) -> None:
        self.call = 0.0
        self._motors = motors

    def set(self, throttles: Sequence[float]) -> None:
        began = time.monotonic()
        try:
            self._motors.set(throttles)
        finally:
            self.call = max(self.call, time.monotonic() - began)


class Driving:
    """A process that drives."""

    PROGRAM = """
import json, sys, threading
from vehicle.motors.drivers import open_motors
motors = open_motors(sys.argv[1], json.loads(sys.argv[2]))
motors.enable()
while True:
    motors.set((0.5, -0.5))
    threading.Event().wait(0.02)
"""

    def __init__(self, kind: str, settings: dict[str, Any]) -> None:
        self._process = subprocess.Popen([sys.executable, "-c", self.PROGRAM, kind, json.dumps(settings)])

    def __enter__(self) -> subprocess.Popen[bytes]:
        return self._process

    def __exit__(self, *_: object) -> None:
        self._process.kill()
        self._process.wait()


class TestRoboClaw(SerialContract):
    kind = "roboclaw"

    def test_the_timeout_is_set_and_read_back_before_it_turns(self, line: OnPty) -> None:
        motors = RoboClawMotors(RoboClawSettings(port=line.path, timeout=0.5))
        assert line.controller.timeout == 0.0
        motors.enable()
        assert line.controller.timeout == 0.5

    @pytest.mark.parametrize("kept", [0.0, 0.1])
    def test_it_does_not_enable_with_another_timeout_than_it_set(self, line: OnPty, kept: float) -> None:
        line.controller.longest_timeout = kept
        motors = RoboClawMotors(RoboClawSettings(port=line.path))
        with pytest.raises(MotorError, match=rf"its serial timeout is {kept:g} s, not 0.3 s"):
            motors.enable()
        motors.set((1.0, 1.0))
        motors.disable()
        assert line.controller.outputs == [0.0, 0.0]

    def test_it_proves_its_timeout_and_turns_nothing(self, line: OnPty) -> None:
        motors = RoboClawMotors(RoboClawSettings(port=line.path, timeout=0.5))
        arming_check(motors)()
        motors.set((1.0, 1.0))
        assert line.controller.timeout == 0.5
        assert line.controller.outputs == [0.0, 0.0]
        line.controller.longest_timeout = 0.1
        with pytest.raises(MotorError, match=r"its serial timeout is 0.1 s, not 0.5 s"):
            arming_check(motors)()

    def test_a_damaged_reply_is_asked_for_again(self, line: OnPty) -> None:
        motors = RoboClawMotors(RoboClawSettings(port=line.path))
        line.controller.garbled = 2
        motors.enable()
        motors.disable()
        line.controller.garbled = 3
        with pytest.raises(MotorError, match="invalid reply"):
            motors.enable()

    def test_it_tells_its_version(self, line: OnPty) -> None:
        motors = RoboClawMotors(RoboClawSettings(port=line.path))
        assert motors.version() == "USB Roboclaw 2x7a v4.2.8"
        line.controller.mute = True
        with pytest.raises(MotorError, match="invalid reply, none"):
            motors.version()

    def test_no_reply_at_start_is_said_with_what_to_look_at(self, line: OnPty) -> None:
        line.controller.mute = True
        with pytest.raises(MotorError, match="no reply: is it on, in packet serial mode") as caught:
            RoboClawMotors(RoboClawSettings(port=line.path))
        assert "\n" not in str(caught.value)

    def test_missing_replies_while_driving_end_it_in_a_fifth_of_a_second(self, bench: Bench, line: OnPty) -> None:
        self.drive(bench)
        line.controller.mute = True
        waits, began = Waits(), time.monotonic()
        assert "no reply" in fault_of(bench.motors, calls=100, pause=0.02)
        assert 0.19 < time.monotonic() - began < 0.2 + MARGIN + waits.total()

    def test_a_dead_controller_holds_each_control_cycle_up_for_one_reply_only(self, line: OnPty) -> None:
        motors = RoboClawMotors(RoboClawSettings(port=line.path))
        line.controller.mute = True
        with pytest.raises(MotorError):
            motors.disable()
        assert min(self.refused_in(motors) for _ in range(10)) < 0.06  # the best of them: the machine is shared
        line.controller.mute = False
        motors.disable()

    @staticmethod
    def refused_in(motors: RoboClawMotors) -> float:
        """s until `disable` gives up."""
        began = time.monotonic()
        with pytest.raises(MotorError):
            motors.disable()
        return time.monotonic() - began

    def test_a_controller_that_lost_its_power_gets_its_timeout_again(self, line: OnPty) -> None:
        times = iter([0.0, 0.02, 1.1, 1.2])
        motors = RoboClawMotors(RoboClawSettings(port=line.path), clock=times.__next__)
        motors.enable()
        line.controller.lose_power()
        motors.set((0.5, 0.5))
        motors.set((0.5, 0.5))
        line.until(lambda: line.controller.timeout == 0.3)

    def test_frames_are_those_of_the_manual(self, line: OnPty) -> None:
        motors = RoboClawMotors(RoboClawSettings(port=line.path, address=0x80))
        motors.enable()
        frames = recorded(motors.port)
        motors.set((1.0, -1.0))
        assert frames[0][:-2] == bytes([0x80, 34, 0x7F, 0xFF, 0x80, 0x01])
        line.outputs_after(frames)
        assert line.controller.bad_packets == 0

    @pytest.mark.parametrize(
        ("settings", "says"),
        [
            ({}, "needs settings, at least port"),
            ({"port": "/dev/x", "timeout": 0.6}, "timeout: Expected `float` <= 0.5"),
            ({"port": "/dev/x", "timeout": 0}, "timeout: Expected `float` >= 0.1"),
            ({"port": "/dev/x", "address": 0x90}, "address: Expected `int` <= 135"),
            ({"port": "/dev/x", "speed": 1}, "unknown field `speed`"),
        ],
    )
    def test_settings_are_read_strictly(self, settings: dict[str, Any], says: str) -> None:
        with pytest.raises(MotorSettingsError) as caught:
            open_motors("roboclaw", settings)
        assert says in str(caught.value)

    def test_a_timeout_between_two_steps_is_rounded_to_the_safe_side(self) -> None:
        controllers = [SerialController("", "", 9600, value, time.monotonic) for value in (0.1, 0.29, 0.3, 0.5)]
        assert [each.timeout_tenths for each in controllers] == [1, 2, 3, 5]


class TestSabertooth(SerialContract):
    kind = "sabertooth"

    def test_it_does_not_enable_before_a_person_has_proven_the_timeout(self, line: OnPty) -> None:
        motors = SabertoothMotors(SabertoothSettings(port=line.path))
        with pytest.raises(MotorError, match="set timeout_proven = true"):
            motors.enable()
        motors.set((1.0, 1.0))
        frames = recorded(motors.port)
        motors.disable()
        assert line.outputs_after(frames) == [0.0, 0.0]

    def test_the_timeout_is_set_at_each_enable(self, line: OnPty) -> None:
        motors = SabertoothMotors(SabertoothSettings(port=line.path, timeout=0.4, timeout_proven=True))
        line.until(lambda: line.controller.timeout == 0.4)
        line.controller.lose_power()
        motors.enable()
        line.until(lambda: line.controller.timeout == 0.4)

    def test_a_controller_that_lost_its_power_while_driving_gets_its_timeout_again(self, line: OnPty) -> None:
        times = iter([0.0, 0.02, 1.1])
        settings = SabertoothSettings(port=line.path, timeout_proven=True)
        motors = SabertoothMotors(settings, clock=times.__next__)
        motors.enable()
        line.controller.lose_power()
        motors.set((0.5, 0.5))
        motors.set((0.5, 0.5))
        line.until(lambda: line.controller.timeout == 0.3)

    def test_a_stop_gets_through_a_line_that_was_full(self, bench: Bench, line: OnPty) -> None:
        motors: Any = bench.motors
        self.drive(bench)
        line.deaf.set()
        assert fault_of(motors, calls=100_000)
        motors.disable()
        line.deaf.clear()
        line.until(lambda: line.controller.outputs == [0.0, 0.0])

    def test_frames_are_those_of_the_manual(self, line: OnPty) -> None:
        """Its example: address 130, command 0, data 64, checksum 66."""
        motors = SabertoothMotors(SabertoothSettings(port=line.path, address=130, timeout_proven=True))
        motors.enable()
        frames = recorded(motors.port)
        motors.set((64 / 127, -1.0))
        assert frames == [bytes([130, 0, 64, 66]) + bytes([130, 5, 127, (130 + 5 + 127) & 127])]

    @pytest.mark.parametrize(
        ("settings", "says"),
        [
            ({"port": "/dev/x", "baud": 4800}, "baud: Invalid enum value 4800"),
            ({"port": "/dev/x", "timeout": 1.0}, "timeout: Expected `float` <= 0.5"),
            ({"port": "/dev/x", "address": 0x80, "proven": True}, "unknown field `proven`"),
        ],
    )
    def test_settings_are_read_strictly(self, settings: dict[str, Any], says: str) -> None:
        with pytest.raises(MotorSettingsError) as caught:
            open_motors("sabertooth", settings)
        assert says in str(caught.value)


@pytest.mark.parametrize("kind", KINDS)
def test_a_rover_whose_controller_proves_no_timeout_cannot_be_armed(kind: str) -> None:
    """The rover itself in its machine; then the same one with a controller that does."""
    make, settings, _ = KINDS[kind]
    for proven in (False, True):
        with OnPty(make()) as line:
            if not proven:
                line.controller.longest_timeout = 0.1
            own = {"port": line.path, **settings, **({"timeout_proven": proven} if kind == "sabertooth" else {})}
            motors = open_motors(kind, own)
            try:
                bench = InMachine(motors)
                bench.wait(CYCLE)
                answer = bench.command(Command.COMPONENT_ARM_DISARM, 1)
                bench.wait(0.5)
                assert (answer is Result.ACCEPTED, bench.armed) == (proven, proven), (answer, bench.texts)
                assert said(bench, "PreArm: motor driver: ") is not proven
                assert line.controller.outputs == [0.0, 0.0]
            finally:
                motors.close()


@pytest.mark.parametrize("kind", KINDS)
def test_a_port_that_is_not_there_is_said_in_one_line(kind: str) -> None:
    with pytest.raises(MotorError, match="/dev/nowhere is not there; is it plugged in") as caught:
        open_motors(kind, {"port": "/dev/nowhere"})
    assert "\n" not in str(caught.value)
    for path in ("/tmp", "/dev/null"):
        with pytest.raises(MotorError, match=f"{path} is not a serial port"):
            open_motors(kind, {"port": path})


@pytest.mark.parametrize("kind", KINDS)
def test_a_port_that_goes_while_it_is_set_up_is_an_error_of_the_motors(
    kind: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    def gone(*words: Any) -> None:  # no pty goes between two calls of the same function; a loose plug does
        raise termios.error(5, "Input/output error")

    with OnPty(RoboClaw()) as line:
        monkeypatch.setattr(termios, "tcsetattr", gone)
        with pytest.raises(MotorError, match="is not there; is it plugged in"):
            open_motors(kind, {"port": line.path})
