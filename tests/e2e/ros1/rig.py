"""ROS 1 as Debian installs it, the simulated rover, and `mavhelm ros1` between them: all real programs."""

from __future__ import annotations

import itertools
import os
import pty
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Sequence
from contextlib import ExitStack, suppress
from pathlib import Path

from tests.e2e.programs import Vehicle
from tests.groundstation.screen import children
from tests.ports import free_port
from tests.waits import PATIENCE, Patience, wait_until

HERE = Path(__file__).parent
COMMAND_NODE = HERE.parents[2] / "docs" / "examples" / "command_node.py"
SYSTEM_PYTHON = "/usr/bin/python3"
TRY = 1.5
"""s for a key to turn the wheels."""


LOST = ("takes no demands in HOLD", "is disarmed; the publisher")
"""What `mavhelm ros1` says where it was late by seconds, and only arming helps."""


class Program:
    """A program, with what it prints."""

    def __init__(self, command: Sequence[str], env: dict[str, str], stdin: int = subprocess.DEVNULL) -> None:
        pipe, out = subprocess.PIPE, subprocess.STDOUT
        self.process = subprocess.Popen(command, env=env, stdin=stdin, stdout=pipe, stderr=out, text=True)
        self.said = ""
        self._reader = threading.Thread(target=self._read, daemon=True)
        self._reader.start()

    def says(self, text: str) -> None:
        """Wait until it has printed a text."""
        wait_until(lambda: text in self.said, f"{text!r} is not in:\n{self.said}")

    def kill(self) -> None:
        """End it as a crash does."""
        self.process.kill()
        self.process.wait(PATIENCE)

    def ended(self) -> int:
        """Wait for its end; return its exit code."""
        code = self.process.wait(PATIENCE)
        self._reader.join(PATIENCE)
        return code

    def _read(self) -> None:
        assert self.process.stdout is not None
        with suppress(ValueError), self.process.stdout as stdout:
            for line in stdout:
                self.said += line


class Core:
    """roscore on a port of its own."""

    def __init__(self, env: dict[str, str], port: int) -> None:
        self.program = Program(["roscore", "-p", str(port)], env)
        self.program.says("started core service")

    @property
    def master(self) -> int:
        """Process id of the master."""
        [pid] = [each for each in children(self.program.process.pid) if "rosmaster" in _command_line(each)]
        return pid

    def end(self) -> None:
        """End it and what it has started, in any state."""
        if self.program.process.returncode is not None:
            return
        started = children(self.program.process.pid)
        self.program.kill()
        for pid in started:
            with suppress(ProcessLookupError):
                os.kill(pid, signal.SIGKILL)


class CommandNode:
    """The node that reads keys, in a pty."""

    def __init__(self, env: dict[str, str]) -> None:
        self._keys, terminal = pty.openpty()
        self.program = Program([SYSTEM_PYTHON, str(COMMAND_NODE)], env, terminal)
        os.close(terminal)

    def press(self, key: str) -> None:
        """Press a key."""
        os.write(self._keys, key.encode())

    def end(self) -> None:
        """End it in any state."""
        self.program.kill()
        os.close(self._keys)


class Rig:
    """roscore, vehicle and `mavhelm ros1 --arm`; nodes on request."""

    def __init__(self, folder: Path, stack: ExitStack) -> None:
        self._stack = stack
        port, self._ros_port = free_port(), free_port()
        self.env = {
            **os.environ,
            "ROS_MASTER_URI": f"http://127.0.0.1:{self._ros_port}",
            "ROS_IP": "127.0.0.1",
            "ROS_HOME": str(folder / "ros"),
        }
        self.endpoint = f"udpin:127.0.0.1:{port}"
        self.core = self.start_core()
        self.vehicle = Vehicle(folder, port)
        stack.callback(self.vehicle.end)
        self.station = self.start_station()

    def start_core(self) -> Core:
        """Start a roscore."""
        core = Core(self.env, self._ros_port)
        self._stack.callback(core.end)
        return core

    def start_station(self) -> Program:
        """Start `mavhelm ros1 --arm` and wait until it has armed."""
        words = ["ros1", "--arm", "-e", self.endpoint, "--station", "never", "--wait", "30"]
        station = Program([sys.executable, "-m", "groundstation", *words], self.env)
        self._stack.callback(station.kill)
        station.says("publish to command or cmd_vel")
        return station

    def command_node(self) -> CommandNode:
        """Start a command_node."""
        node = CommandNode(self.env)
        self._stack.callback(node.end)
        return node

    def script(self, name: str) -> Program:
        """Start another script beside this file."""
        program = Program([SYSTEM_PYTHON, "-u", str(HERE / name)], self.env)
        self._stack.callback(program.kill)
        return program

    def stops(self) -> None:
        """Wait until the wheels have stopped."""
        wait_until(self.vehicle.stands, f"the wheels turn on\n{self.station.said}")

    def drives(self, node: CommandNode, key: str = "i") -> None:
        """Stop, then press a key until the wheels turn."""
        self.presses(node, "k", lambda: not self.vehicle.turning())
        self.presses(node, key, self.vehicle.turning)

    def presses(self, node: CommandNode, key: str, until: Callable[[], bool]) -> None:
        """Press a key again until a condition holds: command_node loses keys, as the article's does.

        Each third try is neutral: a station that stood still takes no motion of a publisher before it has sent zero.
        One that was so late that the rover went to HOLD begins anew.
        """
        patience = Patience()
        for each in itertools.cycle((key, key, "k")):
            if until():
                return
            assert not patience.ended, f"{key}\n{self.station.said}\n{self.vehicle.errors.read_text()}"
            if any(lost in self.station.said for lost in LOST):
                self.station.kill()
                self.station = self.start_station()
            node.press(each)
            again = time.monotonic() + TRY
            while not until() and time.monotonic() < again:
                time.sleep(0.01)


def _command_line(pid: int) -> str:
    with suppress(OSError):
        return Path(f"/proc/{pid}/cmdline").read_text()
    return ""
