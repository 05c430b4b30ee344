"""The contract of drivers for controllers with a serial timeout, and what their tests share."""

from __future__ import annotations

import json
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator, Sequence
from functools import cached_property
from typing import Any

import pytest

from link.core import Received
from tests.vehicle.bench import Bench as RoverBench
from tests.vehicle.motors.contract import Bench, MotorsContract
from tests.vehicle.motors.controllers import RoboClaw, Sabertooth
from tests.vehicle.motors.pty_controller import OnPty, recorded
from tests.waits import Waits
from vehicle.control_loop import ControlLoop
from vehicle.motors import MotorError, Motors, arming_check, roboclaw
from vehicle.motors.drivers import open_motors, safe_stop
from vehicle.sensors import NoSensors

MARGIN = 0.25
"""s more than its timeout that a controller may take here, and what the machine makes it wait: others work on it."""

PATIENT_TRIES = 40
"""0.8 to 2 s for the thread at the other end to answer, in place of 0.06 to 0.15 s: the machine may be late."""

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
    def line(self, monkeypatch: pytest.MonkeyPatch) -> Iterator[OnPty]:
        monkeypatch.setattr(roboclaw, "TRIES", PATIENT_TRIES)
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

    def test_after_kill_9_controller_stops_and_safe_stop_confirms(self, line: OnPty) -> None:
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

    PROGRAM = f"""
import json, sys, threading
from vehicle.motors import roboclaw
from vehicle.motors.drivers import open_motors
roboclaw.TRIES = {PATIENT_TRIES}
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
