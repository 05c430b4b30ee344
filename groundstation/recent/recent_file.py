"""RecentFile: the endpoints used before, in one file of the user. No fault of it keeps the program from its work."""

from __future__ import annotations

import contextlib
import fcntl
import os
import time
from collections.abc import Callable, Iterator
from pathlib import Path

from platformdirs import user_state_path

from groundstation.recent.recent import RecentEndpoints, RecentError, decode, encode
from link.runtime.whole_file import PRIVATE, replace_file
from link.toml.file import read_regular_file

FILE = "recent.json"

MAX_SIZE = 64 * 1024
"""Bytes of a file that is read: five times what the entries can need."""

LOCK_TRIES, LOCK_PAUSE = 20, 0.01
"""How often the lock is tried, and s between: others hold it for a millisecond."""


def default_path() -> Path:
    """Return the path in the user's state folder: $XDG_STATE_HOME/mavhelm on Linux."""
    return user_state_path("mavhelm") / FILE


class RecentFile:
    """Loads and changes the file. Several programs may do so at the same time."""

    def __init__(self, path: Path | None = None) -> None:
        self.path = path or default_path()
        self.warning: str | None = None
        """One line for the user about the last call: the file was damaged, or cannot be read or written."""

    def load(self) -> RecentEndpoints:
        """Return the entries; none if there is no file. A damaged file is renamed to NAME.damaged."""
        self.warning = None
        try:
            return decode(read_regular_file(self.path, MAX_SIZE))
        except FileNotFoundError:
            pass
        except RecentError as error:
            aside = self.path.with_name(f"{self.path.name}.damaged")
            self.warning = f"{self.path} is damaged and not used: {error}"
            with contextlib.suppress(OSError):
                self.path.replace(aside)
                self.warning = f"{self.path} was damaged and is now {aside.name}: {error}"
        except OSError as error:
            self.warning = f"{self.path} is not used: {error.strerror}"
        return RecentEndpoints()

    def update(self, change: Callable[[RecentEndpoints], RecentEndpoints]) -> RecentEndpoints:
        """Change the file: `change` gets the entries of now and returns the new ones. Returns what then holds."""
        try:
            self.path.parent.mkdir(parents=True, exist_ok=True)
            with self._locked():
                before = self.load()
                after = change(before)
                if after != before or self.warning:
                    replace_file(self.path, encode(after), mode=PRIVATE)
                return after
        except OSError as error:
            after = change(self.load())
            self.warning = f"{self.path} cannot be written: {error.strerror}"
            return after

    @contextlib.contextmanager
    def _locked(self) -> Iterator[None]:
        """Hold a lock on the folder. A program that holds it for long is stopped, and is not waited for."""
        folder = os.open(self.path.parent, os.O_RDONLY | os.O_DIRECTORY | os.O_CLOEXEC)
        try:
            for _ in range(LOCK_TRIES):
                with contextlib.suppress(BlockingIOError):
                    fcntl.flock(folder, fcntl.LOCK_EX | fcntl.LOCK_NB)
                    break
                time.sleep(LOCK_PAUSE)
            yield
        finally:
            os.close(folder)
