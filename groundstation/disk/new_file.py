"""Large files and folders that are there whole or not at all: made beside their place, and moved there at the end."""

from __future__ import annotations

import contextlib
import os
import secrets
import shutil
from pathlib import Path
from typing import BinaryIO

from link.runtime.whole_file import SHARED


class NewFile:
    """A file. What is not a regular file, such as a pipe, is written directly. Raises OSError."""

    def __init__(self, path: str) -> None:
        self.path = path
        self._target = Path(path).absolute()
        self._temporary: Path | None = None
        if self._target.exists() and not self._target.is_file():
            self.file: BinaryIO = self._target.open("wb")
            return
        self._temporary = _beside(self._target)
        flags = os.O_WRONLY | os.O_CREAT | os.O_EXCL | os.O_CLOEXEC
        self.file = os.fdopen(os.open(self._temporary, flags, SHARED), "wb")

    def commit(self) -> None:
        """Move the file to its place, in place of one that is there."""
        self.file.close()
        if self._temporary is not None:
            self._temporary.replace(self._target)
            self._temporary = None

    def discard(self) -> None:
        """Remove what is not in its place; nothing after commit(). Never raises."""
        with contextlib.suppress(OSError):
            self.file.close()
        if self._temporary is not None:
            with contextlib.suppress(OSError):
                self._temporary.unlink()


class NewFolder:
    """A folder. If it is there already, its files are replaced by those of the same name. Raises OSError."""

    def __init__(self, path: str) -> None:
        self.path = path
        self._target = Path(path).absolute()
        self.folder = _beside(self._target)
        self.folder.mkdir()

    def commit(self) -> None:
        """Move the folder to its place, or its files into the one that is there."""
        if not self._target.exists():
            self.folder.rename(self._target)
            return
        for each in sorted(self.folder.iterdir()):
            each.replace(self._target / each.name)
        self.folder.rmdir()

    def discard(self) -> None:
        """Remove what is not in its place; nothing after commit(). Never raises."""
        shutil.rmtree(self.folder, ignore_errors=True)


def _beside(target: Path) -> Path:
    return target.with_name(f".{target.name}.{secrets.token_hex(4)}")
