"""`mavhelm reboot` with a vehicle as ArduPilot behaves: progress, the vehicle's own words, silence."""

from __future__ import annotations

import pytest

from groundstation.verbs.common.exit_codes import ExitCode
from tests.fakes.services import foreign_vehicle
from tests.groundstation.verbs.verb_runs import run_verb

REBOOT = 246


@pytest.mark.parametrize(
    ("answer", "code", "words"),
    [
        ((0, ""), ExitCode.DONE, "ArduPilot rover 1 restarts"),
        ((4, "Disarm before reboot"), ExitCode.REFUSED, 'reboot: refused, FAILED, "Disarm before reboot"'),
        ((3, ""), ExitCode.REFUSED, "reboot: refused, UNSUPPORTED"),
        (None, ExitCode.NO_ANSWER, "reboot: no answer, after 6 tries"),
    ],
)
def test_how_it_ends(capsys: pytest.CaptureFixture[str], answer: tuple[int, str] | None, code: int, words: str) -> None:
    with foreign_vehicle() as vehicle:
        if answer is None:
            vehicle.silent.add(76)  # COMMAND_LONG
        else:
            vehicle.answers[REBOOT] = answer
        run = run_verb(capsys, "reboot", "-e", vehicle.endpoint, "-v", "1")
        assert run.code == code, run.err
        assert words in run.err
        sent = [message for message in vehicle.of("COMMAND_LONG") if message.command == REBOOT]
        assert [message.param1 for message in sent] == [1.0] * (6 if answer is None else 1)
