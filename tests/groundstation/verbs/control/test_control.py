"""`mavhelm control` with a vehicle that does not manage control, as ArduPilot behaves, on real sockets."""

from __future__ import annotations

import pytest

from groundstation.verbs.common.exit_codes import ExitCode
from tests.fakes.services import foreign_vehicle
from tests.groundstation.verbs.verb_runs import run_verb

REQUEST_CONTROL = 32100


@pytest.mark.parametrize("words", [("request",), ("release",), ("give", "255")])
def test_a_vehicle_that_does_not_manage_control(capsys: pytest.CaptureFixture[str], words: tuple[str, ...]) -> None:
    with foreign_vehicle() as vehicle:
        vehicle.answers = {REQUEST_CONTROL: (3, ""), 512: (3, "")}
        run = run_verb(capsys, "control", *words, "-e", vehicle.endpoint, "-v", "1")
        assert run.code == 0, run.err
        assert "does not manage control" in run.err
        shown = run_verb(capsys, "control", "show", "-e", vehicle.endpoint)
        assert shown.out == "ArduPilot rover 1 does not tell who is in control\n"


def test_a_refused_request(capsys: pytest.CaptureFixture[str]) -> None:
    with foreign_vehicle() as vehicle:
        vehicle.answers[REQUEST_CONTROL] = (4, "not now")
        run = run_verb(capsys, "control", "request", "-e", vehicle.endpoint, "-v", "1")
        assert (run.code, "not now" in run.err) == (ExitCode.REFUSED, True)


def test_vehicle_accepts_the_dialect_question_without_an_answer(
    capsys: pytest.CaptureFixture[str],
) -> None:
    with foreign_vehicle(autopilot=0) as vehicle:
        run = run_verb(capsys, "control", "request", "-e", vehicle.endpoint, "-v", "1")
        assert run.code == 0, run.err
        assert REQUEST_CONTROL in [each.command for each in vehicle.of("COMMAND_LONG")]
