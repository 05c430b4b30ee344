"""`mavhelm api` as a program of any language sees it, with vehicles as ArduPilot behaves."""

from __future__ import annotations

import json
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import pytest

from groundstation.rover.protocol import MAX_LINE
from tests.fakes.params import Param
from tests.fakes.services import ForeignVehicle, foreign_vehicle
from tests.ports import free_port
from tests.waits import PATIENCE

DRIVE, FULL = ("drive", "--throttle", "40", "--for", "9"), 400


class Api:
    """The process, and what it has answered."""

    def __init__(self, *options: str) -> None:
        self.ended: list[Any] = []
        """Ends of calls that were read past."""
        self._process = subprocess.Popen(
            [sys.executable, "-m", "groundstation", "api", "--station", "never", *options],
            stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
        )  # fmt: skip

    def send(self, *values: object) -> None:
        """Send values as lines; bytes as they are."""
        assert self._process.stdin is not None
        for value in values:
            self._process.stdin.write(value if isinstance(value, bytes) else json.dumps(value).encode() + b"\n")
        self._process.stdin.flush()

    def read(self, kind: str) -> Any:
        """Return the next answer of a type."""
        assert self._process.stdout is not None
        while line := self._process.stdout.readline():
            answer = json.loads(line)
            if answer["type"] == kind:
                return answer
            if answer["type"] == "ended":
                self.ended.append(answer)
        raise AssertionError(f"no {kind}: {self.end()}")

    def start_driving(self, vehicle: ForeignVehicle) -> int:
        """Drive, again if the machine was late; return the number of the call that drives."""
        number = 1
        self.send(call(number, *DRIVE))
        while not any(each.z == FULL for each in vehicle.of("MANUAL_CONTROL")):
            self.read("state")
            if self.ended:
                self.ended.clear()
                self.send(call(number := number + 1, *DRIVE))
            self.send({"type": "waiting"})
        return number

    def end(self) -> tuple[int, str]:
        """End its input; return its exit code and what it has printed to stderr."""
        _, errors = self._process.communicate(timeout=PATIENCE)
        return self._process.returncode, errors.decode()

    def kill(self) -> None:
        """End it in any state."""
        self._process.kill()
        self._process.communicate()


@contextmanager
def api(vehicle: ForeignVehicle, *options: str) -> Iterator[Api]:
    """Run it with a vehicle."""
    process = Api("-e", vehicle.endpoint, "-v", "1", *options)
    try:
        yield process
    finally:
        process.kill()


@pytest.fixture
def vehicle() -> Iterator[ForeignVehicle]:
    with foreign_vehicle() as vehicle:
        vehicle.beat_period = 0.1
        vehicle.params["FS_TIMEOUT"] = Param(1.5)
        yield vehicle


def call(number: int, *words: str) -> dict[str, object]:
    return {"type": "call", "id": number, "words": words}


def test_states_calls_and_the_end_of_the_input(vehicle: ForeignVehicle) -> None:
    with api(vehicle) as program:
        assert program.read("ready") == {"type": "ready", "system": 1, "name": "ArduPilot rover 1"}
        assert program.read("state")["state"]["armed"] is False
        program.send(call(1, "param", "get", "FS_TIMEOUT"), call(2, "arm"))
        assert program.read("record")["fields"]["param_value"] == 1.5
        assert program.read("ended") == {"type": "ended", "id": 1, "code": 0, "text": "", "fields": {}}
        assert program.read("ended")["code"] == 0
        assert vehicle.armed
        code, errors = program.end()
        assert (code, vehicle.armed) == (0, False), errors


def test_a_program_may_leave_it_armed(vehicle: ForeignVehicle) -> None:
    with api(vehicle, "--stay-armed") as program:
        program.send(call(1, "arm"))
        assert program.read("ended")["code"] == 0
        assert program.end()[0] == 0
        assert vehicle.armed


def test_a_vehicle_that_was_armed_before_stays_armed(vehicle: ForeignVehicle) -> None:
    vehicle.armed = True
    with api(vehicle) as program:
        program.send(call(1, "arm"))
        assert program.read("ended")["code"] == 0
        assert program.end()[0] == 0
        assert vehicle.armed


def test_a_drive_without_a_program_that_waits_ends_with_neutral(vehicle: ForeignVehicle) -> None:
    vehicle.armed = True
    with api(vehicle) as program:
        program.start_driving(vehicle)
        ended = program.read("ended")
        assert ended["code"] == 1
        assert "stood still" in ended["text"]
        assert vehicle.of("MANUAL_CONTROL")[-1].z == 0


def test_waiting_for_another_call_does_not_keep_it_driving(vehicle: ForeignVehicle) -> None:
    vehicle.armed = True
    with api(vehicle) as program:
        number = program.start_driving(vehicle)
        program.send(call(99, *DRIVE))
        while not program.ended:
            program.send({"type": "waiting", "id": 99})
            program.read("state")
        assert program.ended[0]["id"] == number
        assert "stood still" in program.ended[0]["text"]


def test_a_call_that_is_cancelled_ends_with_neutral(vehicle: ForeignVehicle) -> None:
    vehicle.armed = True
    with api(vehicle) as program:
        number = program.start_driving(vehicle)
        program.send({"type": "cancel", "id": number})
        assert program.read("ended")["text"] == "cancelled"
        assert vehicle.of("MANUAL_CONTROL")[-1].z == 0


def test_a_stop_does_not_wait_for_a_drive(vehicle: ForeignVehicle) -> None:
    vehicle.armed = True
    with api(vehicle) as program:
        number = program.start_driving(vehicle)
        program.send(call(99, "disarm"))
        assert [program.read("ended")["id"] for _ in range(2)] == [number, 99]
        assert not vehicle.armed


REFUSED = {
    ("param", "get", "NO_SUCH"): (7, "NO_SUCH"),
    ("mode", "FLY"): (4, "no such mode"),
    ("drive", "--throttle", "400", "--for", "1"): (2, "-100 to 100"),
    ("drive", "--throttle", "40", "--for", "1"): (4, "is disarmed"),
    ("fly",): (2, "'fly' is not a verb"),
    (): (2, "is not a verb"),
    ("record", "x.tlog"): (2, "not for programs"),
    ("api",): (2, "not for programs"),
    ("sign", "list"): (2, "not for programs"),
    ("doctor",): (2, "not for programs"),
    ("param", "--help"): (2, "param"),
    ("mission", "put", "missing.plan"): (2, "missing.plan"),
    ("disarm", "--all"): (2, "one vehicle"),
    ("status", "-e", "udpin:127.0.0.1:1"): (2, "one vehicle"),
}


def test_mistakes_are_answered_and_end_nothing(vehicle: ForeignVehicle) -> None:
    with api(vehicle) as program:
        program.read("ready")
        for number, (words, (code, text)) in enumerate(REFUSED.items()):
            program.send(call(number, *words))
            ended = program.read("ended")
            assert (ended["id"], ended["code"]) == (number, code), (words, ended)
            assert text in ended["text"], (words, ended)
            assert "\n" not in ended["text"]
        assert program.end()[0] == 0


@pytest.mark.parametrize(
    ("line", "text"),
    [
        (b"arm\n", "not a call"),
        (b'{"type": "call", "id": "one", "words": []}\n', "not a call"),
        (b'{"type": "fly"}\n', "not a call"),
        (b"\xff\xfe\n", "not a call"),
        (b"[" * (MAX_LINE + 1) + b"\n", "longer than"),
    ],
    ids=["text", "wrong type", "no such call", "bytes", "long"],
)
def test_a_line_that_is_not_a_call_ends_it(vehicle: ForeignVehicle, line: bytes, text: str) -> None:
    with api(vehicle) as program:
        program.read("ready")
        program.send(line)
        code, errors = program.end()
        assert code == 2
        assert text in errors
        assert len(errors.splitlines()) == 1


def test_no_vehicle() -> None:
    process = Api("-e", f"udpin:127.0.0.1:{free_port()}", "--wait", "0.3")
    code, errors = process.end()
    assert code == 3
    assert "no vehicle" in errors
