"""`make stress`: what it runs, that it keeps the cores busy, and that one failure in any round fails it."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

from tests.stress.load import BURN, busy_cores
from tests.stress.results import Round, count_failures, read_round

JUNIT = """\
<testsuites><testsuite>
<testcase classname="tests.e2e.test_a" name="test_good" />
<testcase classname="tests.e2e.test_a" name="test_bad"><failure message="no"/></testcase>
<testcase classname="tests.e2e.test_a" name="test_bad"><error message="at its end"/></testcase>
<testcase classname="tests.e2e.test_a" name="test_left_out"><skipped/></testcase>
</testsuite></testsuites>
"""


def test_a_round_is_read_from_what_pytest_writes(tmp_path: Path) -> None:
    (tmp_path / "round.xml").write_text(JUNIT)
    done = read_round(tmp_path / "round.xml")
    assert done.summary == "1 passed, 1 failed, 1 skipped"
    assert done.failed == ("tests.e2e.test_a::test_bad",)


def test_a_failure_of_any_round_is_counted() -> None:
    rounds = [Round(("a",), ("b",), ()), Round((), ("a", "b"), ()), Round(("a", "b"), (), ())]
    assert count_failures(rounds) == {"b": 2, "a": 1}


def test_burners_compute_and_end_with_the_target() -> None:
    with busy_cores(2) as burners:
        assert [each.poll() for each in burners] == [None, None]
    assert [each.returncode for each in burners] == [-9, -9]


KILLED = """\
import os, subprocess, sys
subprocess.Popen([sys.executable, "-S", "-c", sys.argv[1], str(os.getpid())])
os.kill(os.getpid(), 9)
"""


def test_a_burner_ends_after_a_kill_of_its_parent() -> None:
    ended = subprocess.run([sys.executable, "-c", KILLED, BURN], check=False, stdout=subprocess.PIPE, timeout=60)
    assert ended.returncode == -9  # and the burner, which has the other end of the pipe, has closed it


@pytest.mark.parametrize(("path", "collected"), [("tests/e2e/test_connect.py", True), ("tests/test_world.py", False)])
def test_only_tests_of_programs_and_sockets_are_kept(path: str, collected: bool, tmp_path: Path) -> None:
    file = tmp_path / path
    file.parent.mkdir(parents=True)
    file.write_text("def test_it() -> None:\n    pass\n")
    root = Path(__file__).parents[2]
    words = (
        "-p",
        "tests.stress.selection",
        "-p",
        "no:cacheprovider",
        "--collect-only",
        "-q",
        "--rootdir",
        ".",
        "tests",
    )
    run = subprocess.run(
        [sys.executable, "-m", "pytest", *words],
        cwd=tmp_path, env={"PYTHONPATH": str(root)}, capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert (f"{path}::test_it" in run.stdout) is collected, run.stdout + run.stderr
