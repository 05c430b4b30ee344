"""The folder that keeps parameters over a restart: written by a thread, whole or not at all; the loop never waits.

A new file is written beside the old one, brought to the disk, and takes its name in one step: a power cut leaves the
old file or the new one. A file that is damaged nevertheless is kept aside, and counts until a good one is written.
"""

from __future__ import annotations

import contextlib
import os
import queue
import threading
from pathlib import Path

from vehicle.param_file import DamagedError, dump, parsed

NAME = "parameters"
CLOSING = 2.0
"""s that the end of the program waits for the last write; a disk that takes longer is broken."""


class ParamStore:
    """Fits `vehicle.param_service.Keeper`."""

    def __init__(self, folder: Path) -> None:
        """Reads what there is; never raises."""
        self.path = folder / NAME
        self.aside = folder / f"{NAME}.damaged"
        self.values: dict[str, float] = {}
        """What is kept."""
        self.damage: str | None = None
        """Why the kept values could not be read: the vehicle has its defaults."""
        self.problem: str | None = None
        self._wishes: queue.SimpleQueue[dict[str, float] | None] = queue.SimpleQueue()
        self._thread: threading.Thread | None = None
        self._read()

    def keep(self, name: str, value: float) -> None:
        """Have it written."""
        self.values[name] = value
        self._wishes.put(dict(self.values))
        if self._thread is None:
            self._thread = threading.Thread(target=self._write_on, name="parameters", daemon=True)
            self._thread.start()

    def close(self) -> None:
        """Wait for what is being written."""
        if self._thread is not None:
            self._wishes.put(None)
            self._thread.join(CLOSING)

    def _read(self) -> None:
        try:
            self.values = parsed(self.path.read_bytes())
        except FileNotFoundError:
            if self.aside.exists():
                self.damage = "parameter file damaged"
        except DamagedError:
            self.damage = "parameter file damaged"
            with contextlib.suppress(OSError):  # read-only: then it stays where it is
                self.path.replace(self.aside)
        except OSError as error:
            self.damage = f"parameter file cannot be read, {error.strerror}"

    def _write_on(self) -> None:
        while (values := self._wishes.get()) is not None:
            try:
                self._write(dump(values))
                self.problem = None
            except OSError as error:
                self.problem = str(error.strerror)

    def _write(self, data: bytes) -> None:
        self.path.parent.mkdir(parents=True, exist_ok=True)
        new = self.path.with_suffix(".new")
        descriptor = os.open(new, os.O_WRONLY | os.O_CREAT | os.O_TRUNC | os.O_CLOEXEC, 0o600)
        try:
            written = os.write(descriptor, data)
            if written != len(data):
                raise OSError(0, "No space left on device")
            os.fsync(descriptor)
        finally:
            os.close(descriptor)
        new.replace(self.path)
        self._bring_name_to_disk()

    def _bring_name_to_disk(self) -> None:
        """Without it the new file may be there after a power cut, and its name not."""
        folder = os.open(self.path.parent, os.O_RDONLY | os.O_DIRECTORY | os.O_CLOEXEC)
        try:
            os.fsync(folder)
        finally:
            os.close(folder)
