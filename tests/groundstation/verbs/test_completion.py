"""`groundstation completion`: the scripts, run by the shells that are installed."""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path

import pytest

from groundstation.cli.main import main
from groundstation.cli.verb_help import LOCAL_HELP, VERB_HELP
from groundstation.verbs.completion import COMMON, build_script
from groundstation.verbs.main import build_parser
from groundstation.verbs.table import ONLY, VERBS

HELPS = {**VERB_HELP, **LOCAL_HELP}
ASK = """
COMP_WORDS=({words}); COMP_CWORD=$((${{#COMP_WORDS[@]}} - 1))
_groundstation; printf '%s\\n' "${{COMPREPLY[@]}}"
"""


def complete(words: str, folder: Path) -> set[str]:
    """Return what bash proposes for the last word."""
    script = build_script("bash", HELPS) + ASK.format(words=words)
    ended = subprocess.run(["bash", "-c", script], cwd=folder, capture_output=True, text=True, timeout=30)
    assert (ended.returncode, ended.stderr) == (0, "")
    return set(ended.stdout.split())


@pytest.mark.parametrize(
    ("words", "some"),
    [
        ("groundstation ''", {"arm", "watch", "completion"}),
        ("groundstation es", {"estop"}),
        ("groundstation param ''", {"get", "set", "save", "load", "diff"}),
        ("groundstation param save --c", {"--changed", "--config"}),
        ("groundstation mode H", {"HOLD"}),
        ("groundstation watch VFR", {"VFR_HUD"}),
        ("groundstation command DO_SET_HO", {"DO_SET_HOME"}),
        ("groundstation estop --cl", {"--clear"}),
        ("groundstation config ''", {"check", "show", "init", "path"}),
        ("groundstation mission put pa", {"patrol.plan"}),
    ],
)
def test_bash_proposes(words: str, some: set[str], tmp_path: Path) -> None:
    (tmp_path / "patrol.plan").touch()
    proposed = complete(words, tmp_path)
    assert some <= proposed
    assert "''" in words or len(proposed) == len(some)


def test_every_proposed_option_exists(capsys: pytest.CaptureFixture[str]) -> None:
    for verb, actions in VERBS.items():
        for name, action in actions.items():
            with pytest.raises(SystemExit):
                build_parser(verb).parse_args([*([] if name == ONLY else [name]), "--help"])
            text = capsys.readouterr().out
            assert all(option in text for option in COMMON), (verb, name)
            assert action.help.lower()[:20] in " ".join(text.lower().split())


@pytest.mark.parametrize("shell", ["bash", "zsh", "fish"])
def test_the_script_is_understood_by_its_shell(shell: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["completion", shell]) == 0
    script = capsys.readouterr().out
    assert all(verb in script for verb in HELPS)
    if shutil.which(shell) is None:
        pytest.skip(f"{shell} is not installed")
    ended = subprocess.run([shell, "-n"], input=script, capture_output=True, text=True, timeout=30)
    assert (ended.returncode, ended.stderr) == (0, "")
