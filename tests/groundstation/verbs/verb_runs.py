"""Runs a verb in this process, and returns its exit code and what it printed; waits for conditions."""

from __future__ import annotations

import json
import subprocess
import sys
import time
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass
from typing import Any

import pytest

from groundstation.cli.main import main
from groundstation.verbs.common.exit_codes import ExitCode
from tests.waits import PATIENCE, wait_until

LONG_PATIENCE = 4 * PATIENCE
"""s in which a machine with much to do must once run a verb for as long as it drives."""
START = 20.0
"""s for a program to start and drive; then it is started again."""
_AGAIN = (ExitCode.NO_ANSWER, ExitCode.NO_VEHICLE)


@dataclass(frozen=True)
class VerbRun:
    """How a verb ended."""

    code: int
    out: str
    err: str

    @property
    def records(self) -> list[Any]:
        """The JSON objects on stdout."""
        return [json.loads(line) for line in self.out.splitlines()]


def run_verb(capsys: pytest.CaptureFixture[str], *arguments: str) -> VerbRun:
    """Run `mavhelm arguments`."""
    capsys.readouterr()
    try:
        code = main(arguments)
    except SystemExit as error:
        code = int(error.code or 0)
    captured = capsys.readouterr()
    assert "Traceback" not in captured.err
    return VerbRun(code, captured.out, captured.err)


def run_demanding(*arguments: str) -> VerbRun:
    """Run a verb that sends demands as a process, whose watchdog is a fork; again if a late machine has ended them."""
    deadline = time.monotonic() + LONG_PATIENCE
    while True:
        command = [sys.executable, "-m", "groundstation", *arguments]
        ended = subprocess.run(command, capture_output=True, text=True, timeout=LONG_PATIENCE)
        assert "Traceback" not in ended.stderr
        if "this program stood still" not in ended.stderr or time.monotonic() > deadline:
            return VerbRun(ended.returncode, ended.stdout, ended.stderr)


def start_demanding(
    words: Sequence[str], turning: Callable[[], bool], prepare: Callable[[], object]
) -> subprocess.Popen[str]:
    """Start a verb that drives; again if it, or a failsafe, has ended the demand of a late machine before wheels turn.

    `prepare` arms the vehicle and chooses its mode, each time.
    """
    deadline = time.monotonic() + LONG_PATIENCE
    while True:
        prepare()
        process = subprocess.Popen([sys.executable, "-m", "groundstation", *words], stderr=subprocess.PIPE, text=True)
        if _soon_turns(turning, process):
            return process
        process.kill()
        said = process.communicate()[1]
        assert time.monotonic() < deadline, f"the wheels do not turn: {said}"


def _soon_turns(turning: Callable[[], bool], process: subprocess.Popen[str]) -> bool:
    with suppress(AssertionError):
        wait_until(lambda: turning() or process.poll() is not None, within=START)
    return turning()


def run_until_answered(capsys: pytest.CaptureFixture[str], *arguments: str) -> VerbRun:
    """Run a verb again while it gets no answer: a verb is as patient as a person, and the machine is shared."""
    deadline = time.monotonic() + PATIENCE
    while (run := run_verb(capsys, *arguments)).code in _AGAIN:
        assert time.monotonic() < deadline, run.err
    return run
