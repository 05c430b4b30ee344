"""`mavhelm ros2`: its arguments and what it needs. With a router and a vehicle: tests/e2e/test_ros2.py."""

from __future__ import annotations

import subprocess
import sys

import pytest

from groundstation.verbs.common.exit_codes import ExitCode
from groundstation.verbs.ros.ros2 import DOMAIN_VARIABLE
from link.runtime.install_hint import install_command
from tests.groundstation.verbs.verb_runs import run_verb

Capture = pytest.CaptureFixture[str]


@pytest.mark.parametrize(
    ("words", "error"),
    [
        (["--node", "a/b"], "'a/b' is not letters, digits and _, with a letter first"),
        (["--namespace", "rover"], "'rover' does not begin with /"),
        (["--namespace", "/a*"], "'a*' is not letters"),
        (["--domain", "233"], "'233' is not a domain from 0 to 232"),
        (["--max-speed", "0"], "'0' is not a speed above 0"),
        (["--max-speed", "nan"], "nan"),
        (["--max-turn", "-1"], "'-1' is not a turn rate above 0"),
        (["--rate", "0"], "a rate of 0 sends nothing"),
        (["--router", "nothing.json5"], "nothing.json5"),
        (["--router", "localhost"], "localhost"),
    ],
)
def test_mistakes(capsys: Capture, words: list[str], error: str) -> None:
    wrong = run_verb(capsys, "ros2", *words)
    assert wrong.code == ExitCode.USAGE
    assert error in wrong.err.splitlines()[-1]


def test_a_domain_of_the_environment_that_is_none(capsys: Capture, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(DOMAIN_VARIABLE, "many")
    wrong = run_verb(capsys, "ros2")
    assert (wrong.code, wrong.err) == (2, "mavhelm: ROS_DOMAIN_ID: 'many' is not a domain from 0 to 232\n")


@pytest.mark.parametrize("package", ["zenoh", "rosbags", "xxhash", "numpy"])
def test_a_missing_extra_is_named_in_one_line(package: str) -> None:
    code = (
        "import sys; sys.modules[sys.argv[1]] = None; from groundstation.cli.main import main; sys.exit(main(['ros2']))"
    )
    ended = subprocess.run([sys.executable, "-c", code, package], capture_output=True, text=True, timeout=60)
    assert ended.returncode == ExitCode.USAGE
    assert ended.stderr.endswith(f"which is not installed: {install_command('ros')}\n")
    assert ended.stderr.count("\n") == 1
