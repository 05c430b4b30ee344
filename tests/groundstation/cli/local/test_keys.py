"""`mavhelm keys` in a real pseudo-terminal."""

from __future__ import annotations

import os
import select
import signal
import subprocess
import sys
import termios
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.groundstation.ui.ptys import PRESS_W, RELEASE_W, attach_pty
from tests.waits import PATIENCE


class Keys:
    """The program, and the person's end of its terminal."""

    def __init__(self, folder: Path) -> None:
        self.process, self._master = attach_pty([sys.executable, "-m", "groundstation", "keys"], folder)
        self.printed = ""

    def type(self, data: str, until: str) -> str:
        """Type, and wait for a text; return what was printed since."""
        os.write(self._master, data.encode())
        before = len(self.printed)
        deadline = time.monotonic() + PATIENCE
        while until not in self.printed[before:]:
            assert time.monotonic() < deadline, self.printed
            if select.select([self._master], [], [], 0.1)[0]:
                self.printed += os.read(self._master, 4096).decode()
        return self.printed[before:]

    @property
    def echoes(self) -> bool:
        """Whether the terminal is as it was."""
        return bool(termios.tcgetattr(self._master)[3] & termios.ECHO)

    def end(self) -> None:
        self.process.kill()
        self.process.wait()
        os.close(self._master)


@pytest.fixture
def keys(tmp_path: Path) -> Iterator[Keys]:
    running = Keys(tmp_path)
    running.type("", "q ends")
    yield running
    running.end()


def test_bytes_and_names_until_q(keys: Keys) -> None:
    assert not keys.echoes
    assert "1b 5b 31 35 7e            F5" in keys.type("\x1b[15~", "F5")
    assert "07                        ^g" in keys.type("\x07", "^g")
    assert keys.type("\x1b", "ESC").split()[2] == "1b"
    assert "c3 a4" in keys.type("ä", "c3 a4")
    assert "w" in keys.type(PRESS_W, "w")
    assert "w released" in keys.type(RELEASE_W, "released")
    assert "reports key releases" in keys.type("q", "key releases")
    assert keys.process.wait(PATIENCE) == 0
    assert keys.echoes


def test_a_signal_leaves_the_terminal_as_it_was(keys: Keys) -> None:
    keys.process.send_signal(signal.SIGTERM)
    assert keys.process.wait(PATIENCE) == 128 + signal.SIGTERM
    assert keys.echoes


def test_without_a_terminal() -> None:
    command = [sys.executable, "-m", "groundstation", "keys"]
    ended = subprocess.run(command, stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=PATIENCE)
    assert (ended.returncode, ended.stdout) == (2, "")
    assert "is not a terminal" in ended.stderr
