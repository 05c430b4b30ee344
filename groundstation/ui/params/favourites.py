"""Favourite parameters: names in a file, one a line, for each kind of autopilot."""

from __future__ import annotations

import contextlib
from pathlib import Path

from link.runtime.whole_file import replace_file

MAX_NAMES = 1000
MAX_NAME = 64
"""Characters: a name has 16 bytes, of which each may be escaped."""


class Favourites:
    """The favourites of all kinds of autopilots; each file is read when it is needed first."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._names: dict[str, frozenset[str]] = {}
        self.warning = ""
        """What is wrong with a file, one line; it counts as empty then."""

    def get(self, autopilot: str) -> frozenset[str]:
        """Return the favourites of a kind of autopilot."""
        if autopilot not in self._names:
            self._names[autopilot] = self._read(self._file(autopilot))
        return self._names[autopilot]

    def toggle(self, autopilot: str, name: str) -> str | None:
        """Add or remove a name, and save; return why it could not be saved."""
        self._names[autopilot] = names = self.get(autopilot) ^ {name}
        path = self._file(autopilot)
        try:
            self._folder.mkdir(parents=True, exist_ok=True)
            replace_file(path, "".join(f"{each}\n" for each in sorted(names)).encode())
        except OSError as error:
            return f"favourites are not saved: {error.strerror}: {path}"
        return None

    def _file(self, autopilot: str) -> Path:
        return self._folder / f"favourite-params-{autopilot}.txt"

    def _read(self, path: Path) -> frozenset[str]:
        with contextlib.suppress(FileNotFoundError):
            try:
                text = path.read_text("ascii")
                names = text.splitlines()
                if len(names) <= MAX_NAMES and all(0 < len(name) <= MAX_NAME and name.isprintable() for name in names):
                    return frozenset(names)
                self.warning = f"favourites ignored: {path}: not a list of names"
            except UnicodeDecodeError:
                self.warning = f"favourites ignored: {path}: not a text file"
            except FileNotFoundError:
                raise
            except OSError as error:
                self.warning = f"favourites ignored: {path}: {error.strerror}"
        return frozenset()
