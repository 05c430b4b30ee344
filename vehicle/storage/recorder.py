"""VehicleRecorder: writes received and sent messages to telemetry logs, in a folder that the vehicle serves."""

from __future__ import annotations

from pathlib import Path

from link.protocol.log_tap import LogTap
from link.tlog.recorder import Recorder
from vehicle.storage.disk_folder import DiskFolder
from vehicle.storage.tlog_files import MEGABYTE, SUFFIX, FlightLogLimits, LogFiles, log_time

LOGS = "logs"
"""Name of the default log folder, in the state folder."""


class VehicleRecorder:
    """Fits `vehicle.storage.logbook.LogRecorder`; the runner writes to `log_tap`."""

    def __init__(self, folder: Path, *, system: int, component: int) -> None:
        self._files = LogFiles(folder)
        self._recorder = Recorder()
        self.folder = DiskFolder(folder, suffix=SUFFIX, removable=lambda name: name != self._files.current)
        self.log_tap = LogTap(self._recorder.add, system=system, component=component)
        self._recorder.check_writable(self._files.require_writable)

    @property
    def problem(self) -> str | None:
        """Why messages are not recorded, or not all, one line."""
        return self._recorder.problem

    def start(self, files: int, megabytes_free: int) -> None:
        """Start a new log. Never blocks and never raises."""
        limits = FlightLogLimits(files, megabytes_free * MEGABYTE)
        self._recorder.start(lambda: self._files.open(limits))

    def stop(self) -> None:
        """Close the log."""
        self._recorder.stop()

    def tick(self, now: float) -> None:
        """Pass the collected records to the writing thread."""
        self._recorder.tick(now)

    def remove_all(self) -> None:
        """Remove all logs except the current one."""
        self.folder.clear()

    def unix_time(self, name: str) -> int:
        """Return the start of a log from its name, Unix time in s; 0 if unknown."""
        return log_time(name)

    def close(self) -> None:
        """Write what is left, then stop the threads."""
        self._recorder.close()
        self.folder.close()
