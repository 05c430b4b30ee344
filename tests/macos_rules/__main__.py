"""Run tests with every program that they start under the rules of macOS: `python -m tests.macos_rules [TESTS]`.

The tests themselves look into /proc, so that their own Python stays one of Linux. But its sockets are those of macOS.
"""

from __future__ import annotations

import os
import subprocess
import sys
import time
from pathlib import Path

import pytest

from link.runtime import local_socket

FOLDER = Path(__file__).parent
SELECTION = (
    "tests/macos_rules",
    "tests/e2e/test_stop_matrix.py",
    "tests/e2e/test_in_tmux.py::test_the_first_drive",
    "tests/e2e/test_station_process_lost.py",
    "tests/groundstation/watchdog/test_killed_stations.py",
    "tests/groundstation/test_shared_station.py",
    "tests/groundstation/sitl/test_sitl.py",
    "tests/groundstation/verbs/session/test_through_a_station.py",
)
"""Station, screen in tmux, verbs through a station, watchdog, and the stop matrix."""


def force() -> None:
    """Let this process use the sockets of macOS, and let the programs that it starts follow all rules of macOS."""
    vars(local_socket).update(KEEPS_PACKETS=False, REFUSES_WHEN_FULL=True)
    path = filter(None, (str(FOLDER), os.environ.get("PYTHONPATH")))
    os.environ["PYTHONPATH"] = os.pathsep.join(path)
    words = [sys.executable, "-c", "import os, sys; print(sys.platform, os.path.exists('/proc'))"]
    said = subprocess.run(words, capture_output=True, text=True, check=True).stdout
    if said.split() != ["darwin", "False"]:
        raise SystemExit(f"the rules of macOS are not forced: {said}")


def main(tests: list[str]) -> int:
    """Run the tests, all in this process; return pytest's exit code."""
    force()
    begun = time.monotonic()
    code = pytest.main(["-p", "no:cacheprovider", "-q", "--durations=5", *(tests or SELECTION)])
    print(f"macos_rules: {time.monotonic() - begun:.0f} s")
    return int(code)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
