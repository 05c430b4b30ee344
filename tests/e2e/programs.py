"""The two real programs as a user runs them: the vehicle as a process, the ground station in a real pty."""

from __future__ import annotations

import fcntl
import math
import os
import pty
import re
import select
import signal
import struct
import subprocess
import sys
import termios
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import NamedTuple

from tests.groundstation.held_key import DELAY, GAP
from tests.waits import PATIENCE, Patience

LET_GO = 1.2
"""s without a repeat after which a key counts as released, whatever the ground station has learned (1.1 s at most)."""
AT_REST = 0.5
"""s without motion after which wheels count as stopped."""
PATIENT_LOOP = "FS_LOOP_TIMEOUT=2"
"""A control cycle later than this disarms. The largest value that can be set, because the machine is shared."""


_ESCAPES = re.compile(rb"\x1b\[[0-9;?<>=]*[a-zA-Z]")


class Output(NamedTuple):
    """A line of the motor log."""

    at: float
    """Monotonic, s."""
    throttles: tuple[float, ...]

    @property
    def turning(self) -> bool:
        """True if any wheel gets power."""
        return any(self.throttles)


class Vehicle:
    """`python -m vehicle --sim` with a motor log, on a UDP port of this machine or any other endpoint."""

    def __init__(self, folder: Path, port: int | str, *options: str, within: Sequence[str] = ()) -> None:
        """`within`: the command that runs it in a network namespace."""
        self.motor_log = folder / "motors.log"
        self._outputs: list[Output] = []
        self._read = 0
        """Bytes of the motor log that are in _outputs: waits ask many times a second."""
        self.errors = folder / "vehicle.err"
        endpoint = port if isinstance(port, str) else f"udpout:127.0.0.1:{port}"
        command = [*within, sys.executable, "-m", "vehicle", "--sim", endpoint, "--param", PATIENT_LOOP, *options]
        with self.errors.open("wb") as errors:
            self.process = subprocess.Popen(
                [*command, "--motor-log", str(self.motor_log)], stdout=errors, stderr=errors, stdin=subprocess.DEVNULL
            )

    def outputs(self) -> list[Output]:
        """Return all changes of the motor outputs so far."""
        if self.motor_log.exists():
            with self.motor_log.open("rb") as log:
                log.seek(self._read)
                lines, end, _ = log.read().rpartition(b"\n")
            self._read += len(lines) + len(end)
            rows = (line.split() for line in lines.splitlines())
            self._outputs += [Output(int(at) / 1e9, tuple(map(float, values))) for at, *values in rows]
        return self._outputs[:]

    def turning(self) -> bool:
        """Return whether the wheels turn now."""
        outputs = self.outputs()
        return bool(outputs) and outputs[-1].turning

    def stands(self) -> bool:
        """Return whether the wheels have stopped. A late control cycle outputs zero once; that does not count."""
        outputs = self.outputs()
        return bool(outputs) and not outputs[-1].turning and time.monotonic() - outputs[-1].at > AT_REST

    def at_full(self, least: float = 0.4) -> bool:
        """Return whether both wheels get at least `least` of their power."""
        outputs = self.outputs()
        return bool(outputs) and min(map(abs, outputs[-1].throttles)) >= least

    def moved_since(self, at: float) -> bool:
        """Return whether any wheel got power at or after `at` (monotonic)."""
        return any(each.turning for each in self.outputs() if each.at >= at)

    def falls_and_stops_after(self, at: float) -> tuple[float, float]:
        """Return when, counted from `at`, the outputs first fell, and when they were neutral for good, s.

        Neither is above 0 if the wheels had stopped before `at`: a caller that was delayed sees only the end.
        """
        outputs = self.outputs()
        assert not outputs[-1].turning, f"still turning: {outputs[-1]}"
        power, falls = 0.0, outputs[-1].at
        for each in outputs:
            now = max(map(abs, each.throttles))
            if each.at > at and now < power:
                falls = each.at
                break
            power = now if each.at <= at else max(power, now)
        return falls - at, outputs[-1].at - at

    def end(self) -> None:
        """End the process in any state."""
        _end(self.process)


class GroundStation:
    """`python -m groundstation` in a pty of its own session, as a terminal window gives it."""

    def __init__(
        self,
        folder: Path,
        *arguments: str,
        columns: int = 80,
        lines: int = 24,
        term: str = "xterm-256color",
        module: str = "groundstation",
    ) -> None:
        """`module`: another one that runs it, with something plugged in."""
        self.screen = b""
        self.longest_pause = 0.0
        """s between two writes of keys, the longest since a test has set it to 0."""
        self._typed_at = math.inf
        self.log = folder / "groundstation.log"
        self._terminal, program = pty.openpty()
        fcntl.ioctl(program, termios.TIOCSWINSZ, struct.pack("HHHH", lines, columns, 0, 0))
        self.process = subprocess.Popen(
            [sys.executable, "-m", module, *arguments, "--log-file", str(self.log)],
            stdin=program,
            stdout=program,
            stderr=program,
            start_new_session=True,
            preexec_fn=_own_terminal,
            env={**os.environ, "TERM": term, "COLUMNS": str(columns), "LINES": str(lines)},
        )
        os.close(program)

    def type(self, keys: str) -> None:
        """Send all of `keys` in one write, as a slow SSH does."""
        os.write(self._terminal, keys.encode())
        now = time.monotonic()
        self.longest_pause = max(self.longest_pause, now - self._typed_at)
        self._typed_at = now
        self.look(0.0)

    def hold(self, key: str, until: Callable[[], bool], within: float = PATIENCE) -> None:
        """Hold a key down, with auto-repeat, until the condition `until`; then release it."""
        assert self.held(key, until, within), f"holding {key!r} for {within} s did not do it\n{self.drawn()}"

    def press_until(self, key: str, until: Callable[[], bool]) -> None:
        """Hold a key down until the condition, from time to time anew: a late machine may have closed the gate."""
        patience = Patience(PATIENCE, self.process.pid)
        while not self.held(key, until, 5.0):
            assert not patience.ended, f"pressing {key!r} for {PATIENCE} s did not do it\n{self.drawn()}"
            self.look(LET_GO)

    def held(self, key: str, until: Callable[[], bool], within: float) -> bool:
        """Do the same; return False if the condition is not true within `within` s."""
        deadline = time.monotonic() + within
        self.type(key)
        self.look(DELAY)
        while not until():
            if time.monotonic() > deadline:
                return False
            self.type(key)
            self.look(GAP)
        return True

    def look(self, seconds: float) -> None:
        """Read what the program draws for `seconds`: a terminal that is not read blocks its program."""
        deadline = time.monotonic() + seconds
        while True:
            ready, _, _ = select.select([self._terminal], [], [], max(0.0, deadline - time.monotonic()))
            if not ready:
                return
            try:
                self.screen += os.read(self._terminal, 65536)
            except OSError:
                return  # the program has closed its end

    def wait_for(self, condition: Callable[[], bool], within: float, what: str) -> None:
        """Read the screen until `condition`; the delays of the program are added to `within`."""
        patience = Patience(within, self.process.pid)
        while not self.soon(condition, 1.0):
            assert not patience.ended, f"not within {within} s: {what}\n{self.drawn()}"

    def soon(self, condition: Callable[[], bool], within: float) -> bool:
        """Read the screen until `condition`; return False if it is not true within so many s by the clock."""
        deadline = time.monotonic() + within
        while not condition():
            if time.monotonic() > deadline:
                return False
            self.look(0.02)
        return True

    def says_armed(self) -> bool:
        """Return whether the hint that was drawn last is the one of an armed vehicle."""
        return self.screen.rfind(b"hold i to drive") > self.screen.rfind(b"disarmed:")

    def drawn(self) -> str:
        """Return the end of the drawing without colours and positions, for messages of failed tests."""
        return _ESCAPES.sub(b" ", self.screen)[-2500:].decode(errors="replace") + self.log.read_text()[-1000:]

    def ended(self) -> int:
        """Wait for the end of the program; return its exit code."""
        self.wait_for(lambda: self.process.poll() is not None, PATIENCE, "the ground station ends")
        return int(self.process.returncode)

    def close_terminal(self) -> None:
        """Close the window: the program gets SIGHUP and loses its terminal."""
        os.close(self._terminal)
        self._terminal = -1

    def end(self) -> None:
        """End the program and the processes that it started, in any state."""
        if self.process.returncode is None:  # its process id, and so its group's, is not reused yet
            os.killpg(self.process.pid, signal.SIGKILL)  # a frozen child that only loses its parent never ends
            self.process.wait(PATIENCE)
        if self._terminal >= 0:
            os.close(self._terminal)


def _own_terminal() -> None:
    fcntl.ioctl(0, termios.TIOCSCTTY, 0)


def _end(process: subprocess.Popen[bytes]) -> None:
    if process.poll() is None:
        process.send_signal(signal.SIGCONT)
        process.kill()
    process.wait(PATIENCE)


def drive(station: GroundStation, vehicle: Vehicle, armed: Callable[[], bool], key: str = "i") -> None:
    """Arm with keys and hold one until the wheels turn: every stop test starts like this."""
    station.wait_for(lambda: b"disarmed:" in station.screen, PATIENCE, "the drive screen says how to arm")
    patience = Patience(PATIENCE, station.process.pid, vehicle.process.pid)
    while not (_arms(station, armed) and station.held(key, vehicle.at_full, 5.0)):
        assert not patience.ended, f"it does not drive: {vehicle.errors.read_text()}\n{station.drawn()}"
        _begin_anew(station)


def drive_on(station: GroundStation, vehicle: Vehicle, key: str = "i") -> None:
    """Drive again, still armed, after the vehicle has stopped by itself and changed to HOLD."""
    patience = Patience(PATIENCE, station.process.pid, vehicle.process.pid)
    _begin_anew(station)
    while not station.held(key, vehicle.at_full, 5.0):
        assert not patience.ended, f"it does not drive again: {vehicle.errors.read_text()}\n{station.drawn()}"
        _begin_anew(station)


def _begin_anew(station: GroundStation) -> None:
    """Do what a driver does after a bad link or a frozen screen: release the key, choose MANUAL."""
    station.look(LET_GO)
    station.type("1")
    station.look(0.6)


def _arms(station: GroundStation, armed: Callable[[], bool]) -> bool:
    """Try once to arm: a bad link may lose the command, and a vehicle that has just started refuses it."""
    if armed():
        return True
    station.held("r", armed, 5.0)
    return station.soon(lambda: armed() and station.says_armed(), 3.0)
