"""Progress: which lessons are done, in one file of the user. No fault of it keeps anybody from a lesson."""

from __future__ import annotations

from pathlib import Path

import msgspec
from platformdirs import user_state_path

from link.runtime.whole_file import PRIVATE, replace_file
from link.toml.file import read_regular_file

FILE = "learn.json"
MAX_SIZE = 64 * 1024
"""Bytes of a file that is read: a thousand lessons."""


class Done(msgspec.Struct, frozen=True):
    """What the file holds."""

    done: tuple[str, ...] = ()
    """Ids of the lessons, in the order in which they were done."""


class Progress:
    """Loads and changes the file."""

    def __init__(self, path: Path | None = None) -> None:
        self.path = path or user_state_path("mavhelm") / FILE
        self.warning = ""
        """One line for the user: the file cannot be read or written; "" for none."""
        self.done = self._load().done

    def add(self, lesson: str) -> None:
        """Note that a lesson is done, also once more: `stamp` tells."""
        others = tuple(each for each in self._load().done if each != lesson)
        self._save(Done((*others, lesson)))

    @property
    def stamp(self) -> int:
        """When the file was written, ns; 0 without one."""
        try:
            return self.path.stat().st_mtime_ns
        except OSError:
            return 0

    def reset(self) -> None:
        """Forget all of it."""
        self._save(Done())

    def _load(self) -> Done:
        try:
            return msgspec.json.decode(read_regular_file(self.path, MAX_SIZE), type=Done)
        except FileNotFoundError:
            return Done()
        except (OSError, msgspec.MsgspecError, UnicodeDecodeError) as error:
            reason = (error.strerror or str(error)) if isinstance(error, OSError) else "it is damaged"
            self.warning = f"{self.path} is not used: {reason}"
            return Done()

    def _save(self, done: Done) -> None:
        self.done = done.done
        try:
            self.path.parent.mkdir(parents=True, exist_ok=True)
            replace_file(self.path, msgspec.json.encode(done), mode=PRIVATE)
        except OSError as error:
            self.warning = f"{self.path} cannot be written: {error.strerror}"
