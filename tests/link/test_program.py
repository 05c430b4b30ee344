"""`mavhelm`: its first word chooses the program, and only that program is imported."""

from __future__ import annotations

import subprocess
import sys

import pytest

from groundstation.cli.verb_help import LOCAL_VERBS
from groundstation.cli.verb_help import PROGRAMS as PROGRAM_ROWS
from groundstation.verbs.completion import LOCAL
from groundstation.verbs.table import VERBS
from link.bridge.__main__ import SUBCOMMANDS as OF_BRIDGE
from link.program import PROGRAMS
from vehicle.cli.subcommands import SUBCOMMANDS as OF_VEHICLE

COUNTED = "import sys; from link.program import main\ntry: main({words})\nfinally: print(*sys.modules, file=sys.stderr)"


def imported(*words: str) -> set[str]:
    """Return the modules that a start has imported."""
    code = COUNTED.format(words=list(words))
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    return set(done.stderr.splitlines()[-1].split())


def test_each_program_is_in_the_help_and_no_verb_has_its_name() -> None:
    assert PROGRAMS.keys() == PROGRAM_ROWS.keys()
    assert not PROGRAMS.keys() & (VERBS | LOCAL_VERBS).keys()


def test_shells_complete_the_subcommands_of_each_program() -> None:
    assert sorted(LOCAL["vehicle"]) == sorted(OF_VEHICLE)
    assert sorted(LOCAL["bridge"]) == sorted(OF_BRIDGE)


@pytest.mark.parametrize(
    ("words", "usage"),
    [
        (["--version"], "mavhelm 0"),
        (["status", "--help"], "usage: mavhelm status "),
        (["vehicle", "--version"], "mavhelm vehicle 0"),
        (["vehicle", "check", "--help"], "usage: mavhelm vehicle check "),
        (["bridge", "--help"], "usage: mavhelm bridge "),
        (["bridge", "doctor", "--help"], "usage: mavhelm bridge doctor "),
    ],
    ids=lambda value: " ".join(value) if isinstance(value, list) else "",
)
def test_the_first_word_chooses_the_program(words: list[str], usage: str) -> None:
    done = subprocess.run([sys.executable, "-m", "link.program", *words], capture_output=True, text=True, check=True)
    assert done.stdout.startswith(usage)


@pytest.mark.parametrize(
    ("words", "absent"),
    [
        (["vehicle", "--help"], ("groundstation", "textual", "link.bridge")),
        (["bridge", "--help"], ("groundstation", "textual", "vehicle")),
        (["--version"], ("vehicle", "link.bridge")),
    ],
    ids=["vehicle", "bridge", "station"],
)
def test_a_start_imports_no_other_program(words: list[str], absent: tuple[str, ...]) -> None:
    found = imported(*words)
    assert [name for name in absent if name in found] == []
