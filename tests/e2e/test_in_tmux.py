"""The first command of the README in a real terminal: arm, hold a key, see the rover move, release it, see it stop."""

from __future__ import annotations

import os
import re
import select
import shlex
import shutil
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from tests.ports import free_port

pytestmark = [
    pytest.mark.e2e,
    pytest.mark.tmux,
    pytest.mark.timeout(120),
    pytest.mark.skipif(
        shutil.which("tmux") is None and "MAVHELM_CI" not in os.environ,
        reason="tmux is not installed: `sudo apt install tmux` to run this test",
    ),
]

PATIENCE = 60.0
"""s for every wait: the machine is shared."""
PAUSE = 0.04
"""s between two polls or two key repeats."""


class Tmux:
    """A tmux server of its own with one window."""

    def __init__(self, folder: Path, columns: int, lines: int, *arguments: str) -> None:
        self._socket = str(folder / "tmux")
        program = [sys.executable, "-m", "groundstation", *arguments, "--log-file", str(folder / "station.log")]
        size = ["-x", str(columns), "-y", str(lines)]
        self._run("-f", "/dev/null", "new-session", "-d", *size, f"{shlex.join(program)}; echo EXIT CODE $?; exec cat")

    def _run(self, *words: str) -> str:
        done = subprocess.run(["tmux", "-S", self._socket, *words], capture_output=True, text=True, timeout=60)
        return done.stdout

    def screen(self) -> str:
        """Return the text on the screen."""
        return self._run("capture-pane", "-p")

    def press(self, *keys: str) -> None:
        """Press keys, by tmux's names."""
        self._run("send-keys", *keys)

    def until(self, condition: Callable[[str], bool], within: float, holding: str | None = None) -> str:
        """Poll until the condition holds for the screen, with a key held meanwhile; return the screen."""
        deadline = time.monotonic() + within
        while not condition(screen := self.screen()):
            assert time.monotonic() < deadline, f"not within {within} s:\n{screen}"
            if holding:
                self.press(holding)
            select.select([], [], [], PAUSE)
        return screen

    def end(self) -> None:
        """Close the terminal and everything in it."""
        self._run("kill-server")


@pytest.fixture
def tmux(tmp_path: Path) -> Iterator[Callable[..., Tmux]]:
    """Return a function that opens a terminal; it is closed at the end of the test."""
    opened: list[Tmux] = []

    def build(columns: int, lines: int, *arguments: str) -> Tmux:
        opened.append(Tmux(tmp_path, columns, lines, *arguments))
        return opened[-1]

    yield build
    for each in opened:
        each.end()


def home_distance(screen: str) -> float:
    """Return the distance between the rover and its home as the map shows it, m."""
    found = re.search(r"home\s+([\d.]+) m", screen)
    return float(found[1]) if found else 0.0


def speed_shown(screen: str) -> bool:
    """Return whether the drive panel shows a motor output."""
    return bool(re.search(r"left\s.*\+[1-9]\d*%", screen))


@pytest.mark.parametrize(("columns", "lines"), [(80, 24), (140, 45)])
def test_the_first_drive(tmux: Callable[..., Tmux], columns: int, lines: int) -> None:
    terminal = tmux(columns, lines, "--sitl")
    terminal.until(lambda screen: "DISARMED" in screen and "arms" in screen, PATIENCE)
    terminal.press("r")
    terminal.until(lambda screen: "Arm?" in screen, PATIENCE)
    terminal.press("y")
    terminal.until(lambda screen: "hold i to drive" in screen, PATIENCE)
    terminal.until(lambda screen: home_distance(screen) > 1.0 and speed_shown(screen), PATIENCE, holding="i")
    stood = terminal.until(lambda screen: re.search(r"left\s.*\+0%", screen) is not None, PATIENCE)
    assert home_distance(stood) > 1.0
    terminal.press("r")
    terminal.until(lambda screen: "DISARMED" in screen, PATIENCE)
    terminal.press("C-q")
    ended = terminal.until(lambda screen: "EXIT CODE" in screen, PATIENCE)
    assert "EXIT CODE 0" in ended
    assert "Traceback" not in ended


def test_waiting_offers_the_simulator(tmux: Callable[..., Tmux]) -> None:
    port = free_port()
    terminal = tmux(80, 24, f"udpin:127.0.0.1:{port}")
    waiting = terminal.until(lambda screen: "waiting for a vehicle" in screen, PATIENCE)
    assert str(port) in waiting
    terminal.press("F5")
    terminal.until(lambda screen: "DISARMED" in screen, PATIENCE)
