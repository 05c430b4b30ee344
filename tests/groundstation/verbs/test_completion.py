"""`mavhelm completion`: the scripts, run by the shells that are installed."""

from __future__ import annotations

import subprocess
from pathlib import Path

import pytest

from groundstation.cli.main import main
from groundstation.verbs.action import ONLY
from groundstation.verbs.completion import COMMON, LOCAL_COMMON, MANY
from groundstation.verbs.main import build_parser
from groundstation.verbs.table import VERBS
from tests.groundstation.verbs.shell import HELPS, InteractiveShell, complete, skip_without


@pytest.mark.parametrize(
    ("words", "some"),
    [
        ("mavhelm ''", {"arm", "watch", "completion"}),
        ("mavhelm es", {"estop"}),
        ("mavhelm vehicle mot", {"motor-test"}),
        ("mavhelm bridge ro", {"router"}),
        ("mavhelm param ''", {"get", "set", "save", "load", "diff"}),
        ("mavhelm param save --c", {"--changed", "--config"}),
        ("mavhelm param save --format ''", {"mavproxy", "qgc", "mp"}),
        ("mavhelm arm ''", {"--wait", "--timeout"}),
        ("mavhelm arm --station o", {"only"}),
        ("mavhelm mode H", {"HOLD"}),
        ("mavhelm watch VFR", {"VFR_HUD"}),
        ("mavhelm command DO_SET_HO", {"DO_SET_HOME"}),
        ("mavhelm estop --cl", {"--clear"}),
        ("mavhelm config ''", {"check", "show", "init", "path"}),
        ("mavhelm calibrate gy", {"gyro"}),
    ],
)
def test_bash_proposes(words: str, some: set[str], tmp_path: Path) -> None:
    proposed = complete(words, tmp_path)
    assert some <= proposed
    assert "''" in words or len(proposed) == len(some)


@pytest.mark.parametrize("shell", ["bash", "zsh", "fish"])
def test_a_person_types_and_presses_tab(shell: str, tmp_path: Path) -> None:
    skip_without(shell)
    (tmp_path / "my plan.plan").touch()
    (tmp_path / "mission").mkdir()
    expected = {
        "esto": ["estop"],
        "miss": ["mission"],  # not the folder of this name
        "mission pu": ["mission", "put"],
        "mode HOL": ["mode", "HOLD"],
        "mission put my": ["mission", "put", "my plan.plan"],
        "param save --chan": ["param", "save", "--changed"],
        "export --mcap my": ["export", "--mcap", "my plan.plan"],
    }
    with InteractiveShell(shell, tmp_path) as typed:
        assert [typed.tab(f"mavhelm {line}") for line in expected] == list(expected.values())


def test_every_proposed_option_exists(capsys: pytest.CaptureFixture[str]) -> None:
    for verb, row in VERBS.items():
        for name, action in row.actions.items():
            with pytest.raises(SystemExit):
                build_parser(verb).parse_args([*([] if name == ONLY else [name]), "--help"])
            text = capsys.readouterr().out
            assert all(option in text for option in (LOCAL_COMMON if action.offline else COMMON)), (verb, name)
            assert all((option in text) == action.many for option in MANY), (verb, name)
            assert action.help.lower()[:20] in " ".join(text.lower().split())


@pytest.mark.parametrize("shell", ["bash", "zsh", "fish"])
def test_the_script_is_understood_by_its_shell(shell: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["completion", shell]) == 0
    script = capsys.readouterr().out
    assert all(verb in script for verb in HELPS)
    skip_without(shell)
    ended = subprocess.run([shell, "-n"], input=script, capture_output=True, text=True, timeout=30)
    assert (ended.returncode, ended.stderr) == (0, "")
