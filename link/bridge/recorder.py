"""The bridge's telemetry log: one file a session, named by its first moment."""

from __future__ import annotations

import datetime
import os
from pathlib import Path

from link.tlog.recorder import RawFile, Recorder


class RecorderError(Exception):
    """There is nowhere to record to; the message is one line."""


def open_recorder(folder: Path) -> tuple[Path, Recorder]:
    """A recorder with a new file in `folder`, and where that is. Raises RecorderError."""
    stamp = datetime.datetime.now().astimezone().strftime("%Y-%m-%dT%H-%M-%S")
    try:
        folder.mkdir(parents=True, exist_ok=True)
        path, file = _new_file(folder, stamp)
    except (FileExistsError, NotADirectoryError):
        raise RecorderError(f"--tlog {folder}: there is a file of that name; name a folder") from None
    except OSError as error:
        raise RecorderError(f"--tlog {folder}: {error.strerror}") from error
    recorder = Recorder()
    recorder.start(lambda: file)
    return path, recorder


def _new_file(folder: Path, stamp: str) -> tuple[Path, RawFile]:
    """A file that was not there before: two sessions in one second are two files."""
    number = 1
    while True:
        path = folder / (f"{stamp}.tlog" if number == 1 else f"{stamp}-{number}.tlog")
        try:
            return path, RawFile(os.open(path, os.O_WRONLY | os.O_CREAT | os.O_EXCL | os.O_CLOEXEC, 0o666))
        except FileExistsError:
            number += 1
