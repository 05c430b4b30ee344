"""Texts of parameters on this machine: the user's files, and what vehicles have served before, by their checksum."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator, MutableMapping
from pathlib import Path

from platformdirs import user_cache_path, user_config_path

from groundstation.formats.docs_files import FILE_NAMES, DocsFile, read_docs
from groundstation.station.views.param_texts import ParamTexts
from link.runtime.whole_file import replace_file

MAX_SIZE = 16 * 1024 * 1024
"""Bytes of a file; apm.pdef.xml of ArduRover has 2 MB."""
MAX_CACHED = 20
"""Files that are kept; the oldest goes first."""


class TextCache(MutableMapping[int, bytes]):
    """Files of vehicles in a folder, by the checksum of the general metadata file.

    A folder that cannot be written keeps nothing.
    """

    def __init__(self, folder: Path) -> None:
        self._folder = folder

    def __getitem__(self, key: int) -> bytes:
        try:
            return self._file(key).read_bytes()
        except OSError:
            raise KeyError(key) from None

    def __setitem__(self, key: int, data: bytes) -> None:
        with contextlib.suppress(OSError):
            self._folder.mkdir(parents=True, exist_ok=True)
            replace_file(self._file(key), data)
            for old in self._files()[:-MAX_CACHED]:
                old.unlink()

    def __delitem__(self, key: int) -> None:
        with contextlib.suppress(OSError):
            self._file(key).unlink()

    def __iter__(self) -> Iterator[int]:
        return (int(file.stem, 16) for file in self._files())

    def __len__(self) -> int:
        return len(self._files())

    def _file(self, key: int) -> Path:
        return self._folder / f"{key:08x}.json"

    def _files(self) -> list[Path]:
        """Return the files, the oldest first."""
        return sorted(self._folder.glob("????????.json"), key=lambda file: file.stat().st_mtime)


def load_texts(given: Path | None = None) -> ParamTexts:
    """Read the `given` file, or those in the configuration folder. One that cannot be read names its problem."""
    if given is not None:
        found = [_read(given, None)]
    else:
        folder = user_config_path("mavhelm")
        found = [_read(folder / name, kind) for name, kind in FILE_NAMES.items() if (folder / name).exists()]
    return ParamTexts(tuple(found), TextCache(user_cache_path("mavhelm") / "params"))


def _read(path: Path, autopilot: int | None) -> DocsFile:
    try:
        with path.open("rb") as file:
            data = file.read(MAX_SIZE + 1)
    except OSError as error:
        return DocsFile(autopilot=autopilot, problem=f"{path}: {error.strerror}")
    if len(data) > MAX_SIZE:
        return DocsFile(autopilot=autopilot, problem=f"{path}: more than {MAX_SIZE} bytes")
    return read_docs(data, path.name, autopilot)
