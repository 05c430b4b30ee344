"""The bridge's telemetry log: one file per session, named by its start time."""

from __future__ import annotations

import datetime
import os
from pathlib import Path

from link.tlog.raw_file import RawFile
from link.tlog.recorder import Recorder


class RecorderError(Exception):
    """The log cannot be written; the message is one line."""


def open_recorder(folder: Path) -> tuple[Path, Recorder]:
    """Open a recorder with a new file in `folder`; return the file's path and it. Raises RecorderError."""
    stamp = datetime.datetime.now().astimezone().strftime("%Y-%m-%dT%H-%M-%S")
    try:
        folder.mkdir(parents=True, exist_ok=True)
        path, file = _new_file(folder, stamp)
    except (FileExistsError, NotADirectoryError):
        raise RecorderError(f"--tlog {folder}: a file of that name exists; name a directory") from None
    except OSError as error:
        raise RecorderError(f"--tlog {folder}: {error.strerror}") from error
    recorder = Recorder()
    recorder.start(lambda: file)
    return path, recorder


def _new_file(folder: Path, stamp: str) -> tuple[Path, RawFile]:
    """Create a file that did not exist: two sessions in one second get two files."""
    number = 1
    while True:
        path = folder / (f"{stamp}.tlog" if number == 1 else f"{stamp}-{number}.tlog")
        try:
            return path, RawFile(os.open(path, os.O_WRONLY | os.O_CREAT | os.O_EXCL | os.O_CLOEXEC, 0o666))
        except FileExistsError:
            number += 1
