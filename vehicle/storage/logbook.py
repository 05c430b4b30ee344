"""Logbook: decides when to record telemetry logs, reports problems, and controls who may erase them.

As in ArduPilot, a new log starts at each arming and ends some seconds after disarming; with LOG_DISARMED 1 recording
starts at boot, in a log of its own. A vehicle that cannot record reports it and can still be driven.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from itertools import islice
from typing import Protocol

from dialects import messages as m
from dialects.enums import Severity
from link.core import RECORDER, Outgoing, Received
from link.services.ftp.files import Content, DirectoryEntry, Folder, MemoryFolder, Query, ReadOnlyFolder
from link.services.ftp.protocol import FtpError
from link.services.param.values import REAL32
from link.signing.role import SigningRole
from vehicle.drive.control import Control
from vehicle.drive.roles import role_denial
from vehicle.params import Params
from vehicle.safety.state_machine import Safety
from vehicle.statustext import StatusTextQueue

DISARM_PERSIST = 15.0
"""s of recording after disarming: the log shows why the rover disarmed (ArduPilot's HAL_LOGGER_ARM_PERSIST)."""
PARAMS_PER_CYCLE = 4
"""Parameters recorded in one cycle: all of them take half a second, and no cycle takes long."""


class LogRecorder(Protocol):
    """Writes logs: VehicleRecorder (vehicle/storage/recorder.py) or NullLogRecorder. Never blocks and never raises."""

    @property
    def problem(self) -> str | None:
        """Why messages are not recorded, or not all, one line."""

    @property
    def folder(self) -> Folder:
        """The folder of logs, for FTP and the log protocol."""

    def start(self, files: int, megabytes_free: int) -> None:
        """Start a new log; remove the oldest logs to stay within `files` and to leave `megabytes_free`."""

    def stop(self) -> None:
        """Close the log."""

    def tick(self, now: float) -> None:
        """Pass the collected records to the writing thread. Called in each control cycle."""

    def remove_all(self) -> None:
        """Remove all logs except the current one."""

    def unix_time(self, name: str) -> int:
        """Return the start of a log, Unix time in s; 0 if unknown."""


class NullLogRecorder:
    """The recorder of a vehicle without a log folder: records nothing."""

    problem: str | None = None

    def __init__(self) -> None:
        self.folder = MemoryFolder()

    def start(self, files: int, megabytes_free: int) -> None:
        """Return without an effect."""

    def stop(self) -> None:
        """Return without an effect."""

    def tick(self, now: float) -> None:
        """Return without an effect."""

    def remove_all(self) -> None:
        """Return without an effect."""

    def unix_time(self, name: str) -> int:
        """Return 0."""
        return 0


class Logbook:
    """Starts and stops the recorder in each control cycle."""

    def __init__(
        self,
        params: Params,
        control: Control,
        texts: StatusTextQueue,
        safety: Safety,
        recording: LogRecorder | None,
    ) -> None:
        self.recording = recording or NullLogRecorder()
        self._params = params
        self._control = control
        self._texts = texts
        self._safety = safety
        self._was_armed = False
        self._open = False
        self._until = float("-inf")
        self._opening: Iterator[m.Message] = iter(())
        self._removed: list[str] = []
        """Names of the logs that were removed by FTP and not reported yet."""

    @property
    def is_healthy(self) -> bool | None:
        """Whether recording works; None if it is off (LOG_BACKEND_TYPE 0, or no log folder)."""
        if isinstance(self.recording, NullLogRecorder) or not self._params["LOG_BACKEND_TYPE"]:
            return None
        return self.recording.problem is None

    def tick(self, now: float) -> list[Outgoing]:
        """Start or stop recording. Returns messages for the log only: all parameters, after the start of a log."""
        armed = self._safety.armed
        if self._was_armed and not armed:
            self._until = now + DISARM_PERSIST
        wanted = self.is_healthy is not None and (armed or self._params["LOG_DISARMED"] or now < self._until)
        if wanted and (not self._open or (armed and not self._was_armed)):
            self._texts.reset_once(_KEY)  # each log reports its problem again
            self.recording.start(int(self._params["LOG_MAX_FILES"]), int(self._params["LOG_FILE_MB_FREE"]))
            self._opening = self._values()
        elif self._open and not wanted:
            self.recording.stop()
        self._open, self._was_armed = bool(wanted), armed
        self._report_removed(now)
        self.recording.tick(now)
        return [Outgoing(message, RECORDER) for message in islice(self._opening, PARAMS_PER_CYCLE)]

    def check_health(self, now: float) -> None:
        """Report a recording problem once. Called about once a second."""
        problem = self.recording.problem
        if problem and self.is_healthy is not None:
            self._texts.send_once(f"{_KEY} {problem}", Severity.WARNING, f"Log: {problem}", now)

    def folder(self) -> Folder:
        """Return the logs for MAVLink FTP, whose server checks the sender as well."""
        return _Logs(self.recording.folder, self._removal_denial_reason, self._removed.append)

    def handle_log_erase(self, received: Received, now: float) -> None:
        """Handle LOG_ERASE: remove all logs, for the ground station in control and while disarmed."""
        denial = role_denial(received, SigningRole.SET_UP) or self._control.ownership.denial_reason(received, now)
        denial = denial or self._removal_denial_reason()
        if not received.introduced:
            denial = "its HEARTBEAT is missing"
        if denial is not None:
            text = f"GCS {received.system}: logs not erased: {denial}"
            self._texts.reply(received, Severity.WARNING, text, now)
            return
        self.recording.remove_all()
        self._texts.send(Severity.NOTICE, f"Logs erased by GCS {received.system}", now)

    def _report_removed(self, now: float) -> None:
        for name in self._removed:
            self._texts.send_change(Severity.NOTICE, f"Log {name} removed by GCS {self._control.ownership.owner}", now)
        self._removed.clear()

    def _removal_denial_reason(self) -> str | None:
        """Return why nobody may remove logs now, or None: what is removed is lost, so somebody must be in control."""
        if not self._control.ownership.owner:
            return "no GCS is in control, request it first"
        return "disarm first" if self._safety.armed else None

    def _values(self) -> Iterator[m.Message]:
        count = len(self._params)
        for index, name in enumerate(self._params):
            yield m.ParamValue(name.encode(), self._params[name], REAL32, count, index)


_KEY = "recording"


class _Logs(ReadOnlyFolder):
    """The logs as a `link.services.ftp.files.Folder`: read-only, but files may be removed."""

    def __init__(
        self, logs: Folder, removal_denial_reason: Callable[[], str | None], on_removed: Callable[[str], None]
    ) -> None:
        self._logs = logs
        self._removal_denial_reason = removal_denial_reason
        self._on_removed = on_removed

    def entries(self) -> Sequence[DirectoryEntry]:
        return self._logs.entries()

    def open(self, name: str, query: Query) -> Content | None:
        return self._logs.open(name, query)

    def remove(self, name: str) -> FtpError | None:
        if self._removal_denial_reason() is not None:
            return FtpError.PROTECTED
        error = self._logs.remove(name)
        if error is None:
            self._on_removed(name)
        return error
