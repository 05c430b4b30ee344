"""A run that cannot begin, or whose tests end the process, is reported in one line."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from tests.mutation import baseline
from tests.mutation.baseline import BaselineError, measure

ROOT = Path(__file__).parents[2]
WITHOUT_COVERAGE = (
    "import sys; sys.modules['coverage'] = None; from tests.mutation.__main__ import main; sys.exit(main())"
)


def kill() -> None:
    os.kill(os.getpid(), signal.SIGKILL)


def leave() -> None:
    os._exit(3)


def fail() -> None:
    raise RuntimeError("no tests\nwere collected")


@pytest.mark.parametrize(
    ("end", "text"),
    [
        (kill, "was ended by signal 9"),
        (leave, "exited with code 3"),
        (fail, "raised RuntimeError: no tests were collected"),
    ],
)
def test_a_child_that_ends_without_a_result_is_described(
    end: Callable[[], None], text: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(baseline, "_run_under_coverage", lambda items, paths: end())
    with pytest.raises(BaselineError) as caught:
        measure([], {"vehicle/drive/gate.py"})
    assert str(caught.value) == f"the child that runs the tests {text}"


def test_without_coverage_the_program_says_what_to_install() -> None:
    ran = subprocess.run(
        [sys.executable, "-c", WITHOUT_COVERAGE, "vehicle/drive/gate.py"],
        cwd=ROOT,
        capture_output=True,
        text=True,
        timeout=60,
    )
    assert (ran.returncode, ran.stdout) == (2, "")
    command = f"{sys.executable} -m pip install 'mavhelm[test,mutation]'"
    assert ran.stderr == f"the package coverage is missing: {command}\n"


def test_a_list_of_mutants_needs_no_coverage() -> None:
    ran = subprocess.run(
        [sys.executable, "-c", WITHOUT_COVERAGE, "--list", "vehicle/drive/gate.py"],
        cwd=ROOT,
        capture_output=True,
        text=True,
        timeout=60,
    )
    assert (ran.returncode, ran.stderr) == (0, "")
    assert "vehicle/drive/gate.py:" in ran.stdout
