"""Resets the terminal after a screen process that was killed: back to the main screen, without key and mouse modes."""

from __future__ import annotations

import contextlib
import os
import termios
import time
from typing import Any

RESET = (
    b"\x1b[?2026l"  # show what is drawn
    b"\x1b[?2004l\x1b[?2048l\x1b[?1004l"  # no bracketed paste, no reports of size and focus
    b"\x1b[?1000;1006l\x1b[?1007h\x1b[?1007r"  # the mouse, as ui/terminal/mouse.py does it
    b"\x1b[=0;1u\x1b[<u"  # kitty keyboard protocol off; it is kept for each screen, so before leaving this one
    b"\x1b[?7h\x1b[?1049l\x1b[?25h\x1b[0m"  # wrap lines, main screen, cursor, no colours
)
"""Undoes what ui/terminal/console_driver.py and Textual's LinuxDriver set."""

LAST_TRY = 2.0
"""s to wait for room in the terminal when nothing else is left to do."""
RETRY_PERIOD = 0.02
"""s between two looks for room."""
LOCAL_FLAGS = 3
"""Index in the list of termios.tcgetattr()."""


class TerminalReset:
    """One terminal by its path, as it is before the screen starts. Without a path, or one that is gone: nothing.

    The number of a terminal that is closed goes to the next one that opens, which must not get the reset.
    """

    def __init__(self, path: str | None) -> None:
        self._path = path
        self._identity, self._before = (None, None) if path is None else _look_at(path)
        self._left = RESET

    def run(self) -> bool:
        """Reset the terminal once, without waiting for room: what the screen drew last may fill it.

        Returns True once that is done, or the terminal is gone; else try again.
        """
        if self._path is None:
            return True
        with contextlib.suppress(OSError, termios.error):
            descriptor = os.open(self._path, os.O_RDWR | os.O_NONBLOCK | os.O_NOCTTY)
            try:
                if self._identity in (None, _identify(descriptor)):
                    if not self._write(descriptor):
                        return False
                    self._restore_line(descriptor)
            finally:
                os.close(descriptor)
        self._path = None
        return True

    def insist(self, within: float) -> None:
        """Reset the terminal, waiting at most `within` s for room."""
        until = time.monotonic() + within
        while not self.run() and time.monotonic() < until:
            time.sleep(RETRY_PERIOD)

    def _write(self, descriptor: int) -> bool:
        """Write what has room; return whether nothing is left."""
        with contextlib.suppress(BlockingIOError):
            while self._left:
                self._left = self._left[os.write(descriptor, self._left) :]
        return not self._left

    def _restore_line(self, descriptor: int) -> None:
        """Restore echo and lines, unless a shell has taken the terminal: one that edits lines keeps ISIG."""
        if self._before is not None and not termios.tcgetattr(descriptor)[LOCAL_FLAGS] & termios.ISIG:
            termios.tcsetattr(descriptor, termios.TCSANOW, self._before)


def _look_at(path: str) -> tuple[tuple[int, ...] | None, list[Any] | None]:
    """Return which terminal has this path, and its attributes; None for what cannot be read."""
    try:
        descriptor = os.open(path, os.O_RDONLY | os.O_NONBLOCK | os.O_NOCTTY)
    except OSError:
        return None, None
    try:
        return _identify(descriptor), termios.tcgetattr(descriptor)
    except termios.error:
        return _identify(descriptor), None
    finally:
        os.close(descriptor)


def _identify(descriptor: int) -> tuple[int, ...]:
    """Return what tells a terminal from an earlier one of its number: its node is new, and has a new time of change.

    Neither output nor termios change that time; chmod and chown do.
    """
    found = os.fstat(descriptor)
    return found.st_dev, found.st_ino, found.st_rdev, found.st_ctime_ns
