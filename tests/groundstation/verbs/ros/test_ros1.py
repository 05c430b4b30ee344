"""`mavhelm ros1` with a stand-in for the node; with ROS 1 and our vehicle: tests/e2e/test_ros1.py."""

from __future__ import annotations

import contextlib
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from dialects import messages as m
from groundstation.verbs.common.exit_codes import ExitCode
from tests.fakes.services import ForeignVehicle, foreign_vehicle
from tests.groundstation.ros1.stand_in import StandIn
from tests.groundstation.verbs.verb_runs import run_verb
from tests.waits import PATIENCE, wait_until

Capture = pytest.CaptureFixture[str]
GIVEN = ("-v", "1", "--max-speed", "1", "--max-turn", "1")
"""What the verb would else wait for, or ask the vehicle for."""


class Verb:
    """The verb as a process, with an armed vehicle and a node that a test speaks for."""

    def __init__(self, folder: Path, vehicle: ForeignVehicle, *options: str) -> None:
        self.vehicle = vehicle
        self.node = StandIn(folder)
        words = ["ros1", "--python", str(self.node.python), "-e", vehicle.endpoint, *GIVEN, *options]
        self._errors = folder / "errors"
        with self._errors.open("wb") as errors:
            command = [sys.executable, "-m", "groundstation", *words]
            self.process = subprocess.Popen(command, stderr=errors)

    @property
    def said(self) -> str:
        """What it has printed."""
        return self._errors.read_text()

    def begin(self) -> None:
        """Let the node subscribe; what it says from then on is new."""
        self.node.ready()
        self.says("publish to command or cmd_vel")

    def says(self, text: str) -> None:
        """Wait until it has printed a text."""
        wait_until(lambda: text in self.said, f"{text!r} is not in {self.said}")

    def hears(self, text: str, **line: str) -> None:
        """Let the node say a line until the text is printed: the node before it may read one that comes too soon."""
        while text not in self.said:
            self.node.say(**line)
            with contextlib.suppress(AssertionError):
                wait_until(lambda: text in self.said, within=2.0)
            assert self.process.poll() is None, self.said

    def drives(self, word: str, throttle: int) -> None:
        """Say a word until it is demanded: a program that a busy machine held up wants stop, or silence, first."""
        deadline = time.monotonic() + PATIENCE
        while self._throttle() != throttle:
            assert time.monotonic() < deadline, self.said
            self.node.word("stop")
            self.node.word(word)
            again = time.monotonic() + 0.5
            while self._throttle() != throttle and time.monotonic() < again:
                time.sleep(0.005)

    def demands(self, throttle: int) -> None:
        """Wait until the newest demand is this, -1000 to 1000."""
        wait_until(lambda: self._throttle() == throttle, f"no {throttle}, {self.said}")

    def _throttle(self) -> int | None:
        sent = self.vehicle.of("MANUAL_CONTROL")
        return sent[-1].z if sent else None


@contextmanager
def running(folder: Path, *options: str) -> Iterator[Verb]:
    with foreign_vehicle() as vehicle:
        vehicle.armed = not options
        verb = Verb(folder, vehicle, *options)
        try:
            yield verb
        finally:
            verb.process.kill()
            verb.process.wait(PATIENCE)
            verb.node.close()


def test_words_and_twists_become_demands_and_telemetry_goes_out(tmp_path: Path) -> None:
    with running(tmp_path) as verb:
        verb.begin()
        assert "rover 1 is /mavhelm_1 at http://localhost:11311" in verb.said
        verb.drives("forward", 600)
        verb.demands(0)  # after 0.8 s of silence
        verb.node.twist(-0.5, 0.0)
        verb.demands(-500)
        verb.node.say(topic="cmd_vel", publishers=0)
        verb.demands(0)
        verb.node.word("left", sender="/a\x1b[2J")
        verb.node.word("nonsense")
        verb.says("refused: 'nonsense' is none of forward")
        verb.vehicle.send(m.Attitude(1000, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0))
        wait_until(lambda: [each["topic"] for each in verb.node.told()] == ["imu"], "no telemetry")
        assert verb.node.told()[0]["type"] == "sensor_msgs/Imu"
        verb.process.send_signal(signal.SIGTERM)
        assert verb.process.wait(PATIENCE) == 128 + signal.SIGTERM
        assert "Traceback" not in verb.said


def test_what_waited_before_it_was_read_does_not_drive(tmp_path: Path) -> None:
    with running(tmp_path) as verb:
        verb.begin()
        for _ in range(20):
            verb.node.word("backward", age=0.3)
        verb.drives("forward", 600)
        assert all(each.z >= 0 for each in verb.vehicle.of("MANUAL_CONTROL"))


def test_a_new_node_joins_when_the_master_is_back(tmp_path: Path) -> None:
    with running(tmp_path) as verb:
        verb.begin()
        verb.drives("forward", 600)
        verb.node.say(lost="http://localhost:11311: Connection refused")
        verb.says("the node has left ROS: http://localhost:11311: Connection refused; neutral")
        verb.demands(0)
        verb.hears("no ROS master at http://localhost:11311: start `roscore`", waiting="http://localhost:11311")
        verb.node.ready()
        wait_until(lambda: verb.said.count("publish to") == 2, "the new node is not ready")
        verb.drives("backward", -600)


def test_a_node_that_ends_is_told(tmp_path: Path) -> None:
    with running(tmp_path) as verb:
        verb.begin()
        verb.drives("forward", 600)
        verb.node.end()
        assert verb.process.wait(PATIENCE) == ExitCode.BROKEN
        assert "the node of ROS has ended (code 0); neutral" in verb.said
        verb.demands(0)


def test_it_arms_only_with_a_master_and_disarms(tmp_path: Path) -> None:
    with running(tmp_path, "--arm", "--wait", "2") as verb:
        verb.node.say(waiting="http://localhost:11311")
        assert verb.process.wait(PATIENCE) == ExitCode.NO_ANSWER
        assert "not armed: no ROS master within 2 s (--wait)" in verb.said
        assert not verb.vehicle.armed
    (tmp_path / "again").mkdir()
    with running(tmp_path / "again", "--arm", "--for", "3") as verb:
        verb.node.ready()
        wait_until(lambda: verb.vehicle.armed, f"not armed: {verb.said}")
        assert verb.process.wait(PATIENCE) == ExitCode.DONE
        assert not verb.vehicle.armed


def test_without_rospy_it_says_what_to_install(capsys: Capture) -> None:
    with foreign_vehicle() as vehicle:
        words = ("-e", vehicle.endpoint, *GIVEN)
        missing = run_verb(capsys, "ros1", "--python", sys.executable, *words)
        assert missing.code == ExitCode.USAGE
        assert "has no rospy (No module named 'rosgraph'): apt install python3-rospy" in missing.err
        nowhere = run_verb(capsys, "ros1", "--python", "/nowhere/python", *words)
        assert nowhere.code == ExitCode.USAGE
        assert "--python /nowhere/python: No such file or directory" in nowhere.err


@pytest.mark.parametrize("option", ["--max-speed=0", "--max-turn=-1", "--max-turn=nan", "--for=0"])
def test_mistakes(capsys: Capture, option: str) -> None:
    assert run_verb(capsys, "ros1", option).code == ExitCode.USAGE
