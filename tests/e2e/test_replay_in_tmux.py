"""A log opened from the running screen in a real terminal: there and back, killed and quit, and then driven again."""

from __future__ import annotations

import os
import signal
import termios
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path

from tests.e2e.test_in_tmux import Tmux, speed_shown, tmux
from tests.e2e.tmux_marks import IN_TMUX
from tests.groundstation.replay.logs import drive_log
from tests.waits import PATIENCE

__all__ = ["tmux"]

pytestmark = IN_TMUX

PARENT = "logs here"


def test_a_log_has_the_terminal_until_it_is_killed_or_quit(tmux: Callable[..., Tmux], tmp_path: Path) -> None:
    log = tmp_path / "drive.tlog"
    # Armed from 10 s: a shorter log without that is not listed.
    log.write_bytes(bytes(drive_log(15).data))
    terminal = tmux(140, 45, "--sitl", "--no-record", "--folder", str(tmp_path))
    terminal.until(lambda screen: "hold r to arm" in screen, PATIENCE)
    for kill in (True, False):
        terminal.press("C-g", "0")
        terminal.until(lambda screen: PARENT in screen and "ENTER shows a log" in screen, PATIENCE)
        terminal.press("Enter")
        terminal.until(lambda screen: "REPLAY" in screen and "timeline" in screen, PATIENCE)
        if kill:
            os.kill(find_replay(log), signal.SIGKILL)
            terminal.until(lambda screen: "the replay was ended by signal 9" in screen, PATIENCE)
        else:
            terminal.press("C-q")
        terminal.until(lambda screen: PARENT in screen and "REPLAY" not in screen, PATIENCE)
        terminal.press("Escape")
        terminal.until(lambda screen: "hold r to arm" in screen, PATIENCE)
    terminal.hold_until("r", lambda screen: "hold i to drive" in screen, PATIENCE)
    terminal.drive_until(speed_shown)
    terminal.press("C-g", "0")
    terminal.until(lambda screen: "ENTER shows a log" in screen, PATIENCE)
    terminal.press("Enter")
    terminal.until(lambda screen: "disarm first: a vehicle is armed from here" in screen, PATIENCE)
    terminal.press("C-q")
    ended = terminal.until(lambda screen: "EXIT CODE 0" in screen, PATIENCE)
    assert "Traceback" not in ended
    assert line_modes(terminal) & (termios.ICANON | termios.ECHO) == termios.ICANON | termios.ECHO


def find_replay(log: Path) -> int:
    """Return the process id of `mavhelm replay` of this log."""
    for each in Path("/proc").iterdir():
        with suppress(OSError):  # no process, or one that has ended meanwhile
            words = (each / "cmdline").read_bytes().split(bytes(1))
            if b"replay" in words and str(log).encode() in words:
                return int(each.name)
    raise AssertionError(f"no replay of {log}")


def line_modes(terminal: Tmux) -> int:
    """Return the local modes of the terminal."""
    with open(terminal.tty, "rb", buffering=0) as file:
        modes = termios.tcgetattr(file)[3]
    assert isinstance(modes, int)
    return modes
