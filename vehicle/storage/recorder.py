"""Records what the vehicle hears and says, in a folder of logs that it serves: recorder, files and folder joined."""

from __future__ import annotations

from pathlib import Path

from link.protocol.log_tap import LogTap
from link.tlog.recorder import Recorder
from vehicle.storage.disk_folder import DiskFolder
from vehicle.storage.tlog_files import MEGABYTE, SUFFIX, LogFiles, LogLimits, log_time

LOGS = "logs"
"""In the folder that keeps things, unless another one is named."""


class VehicleRecorder:
    """Fits `vehicle.storage.logbook.LogRecorder`; `tape` is for the runner."""

    def __init__(self, folder: Path, *, system: int, component: int) -> None:
        self._files = LogFiles(folder)
        self._recorder = Recorder()
        self.folder = DiskFolder(folder, suffix=SUFFIX, removable=lambda name: name != self._files.current)
        self.tape = LogTap(self._recorder.add, system=system, component=component)
        self._recorder.check_writable(self._files.require_writable)

    @property
    def problem(self) -> str | None:
        """Why it does not record, or not all, in one line."""
        return self._recorder.problem

    def start(self, files: int, megabytes_free: int) -> None:
        """A new log. Never blocks and never raises."""
        limits = LogLimits(files, megabytes_free * MEGABYTE)
        self._recorder.start(lambda: self._files.open(limits))

    def stop(self) -> None:
        """Close it."""
        self._recorder.stop()

    def tick(self, now: float) -> None:
        """Hand over what has come together."""
        self._recorder.tick(now)

    def remove_all(self) -> None:
        """Remove all logs but the one that is being written."""
        self.folder.clear()

    def unix_time(self, name: str) -> int:
        """By its name."""
        return log_time(name)

    def close(self) -> None:
        """Write the rest and end."""
        self._recorder.close()
        self.folder.close()
