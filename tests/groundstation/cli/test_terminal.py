"""When ASCII is chosen without being asked for."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[3]
LOCALE = ("LANG", "LC_ALL", "LC_CTYPE", "PYTHONUTF8", "TERM")


def needs_ascii(**environment: str) -> bool:
    """Ask in a process of its own: Python settles the locale at its start."""
    rest = {key: value for key, value in os.environ.items() if key not in LOCALE}
    script = "from groundstation.cli.terminal import needs_ascii; print(needs_ascii())"
    done = subprocess.run(
        [sys.executable, "-c", script], capture_output=True, text=True, cwd=ROOT, env=rest | environment, check=True
    )
    return done.stdout.strip() == "True"


@pytest.mark.parametrize(
    ("environment", "expected"),
    [
        ({"LANG": "C.UTF-8", "TERM": "xterm"}, False),
        ({"LANG": "C", "LC_ALL": "C.UTF-8", "TERM": "xterm"}, False),
        ({"LANG": "C", "TERM": "xterm"}, True),
        ({"LANG": "POSIX", "TERM": "xterm"}, True),
        ({"LC_ALL": "C", "LANG": "C.UTF-8", "TERM": "xterm"}, True),
        ({"LANG": "en_US.ISO-8859-1", "TERM": "xterm"}, True),
        ({"TERM": "xterm"}, True),
        ({"LANG": "C.UTF-8", "TERM": "linux"}, True),
        ({"LANG": "C.UTF-8", "PYTHONUTF8": "1", "TERM": "xterm"}, False),
    ],
    ids=str,
)
def test_ascii_where_boxes_and_braille_would_not_show(environment: dict[str, str], expected: bool) -> None:
    assert needs_ascii(**environment) is expected
