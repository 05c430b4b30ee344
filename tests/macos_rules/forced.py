"""A plugin of pytest: forces the rules of macOS on the programs that tests start, and its sockets on the tests.

The tests themselves look into /proc, so that their own Python stays one of Linux. With workers (`-n`) each of them does
it for itself: a worker that was started under the rules could not look into /proc.
"""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from link.runtime import local_socket

FOLDER = Path(__file__).parent


def pytest_configure(config: pytest.Config) -> None:
    """Force the rules in the processes that run tests."""
    if "PYTEST_XDIST_WORKER" in os.environ or not config.getoption("numprocesses", None):
        force()


def force() -> None:
    """Force the rules. Raises SystemExit if that does not work."""
    vars(local_socket).update(KEEPS_PACKETS=False, REFUSES_WHEN_FULL=True)
    path = filter(None, (str(FOLDER), os.environ.get("PYTHONPATH")))
    os.environ["PYTHONPATH"] = os.pathsep.join(path)
    words = [sys.executable, "-c", "import os, sys; print(sys.platform, os.path.exists('/proc'))"]
    said = subprocess.run(words, capture_output=True, text=True, check=True).stdout
    if said.split() != ["darwin", "False"]:
        raise SystemExit(f"the rules of macOS are not forced: {said}")
