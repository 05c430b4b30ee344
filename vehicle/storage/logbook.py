"""When the vehicle records, what it tells of that, and who may remove logs; writing them is the recorder's.

As ArduPilot does it: a new log at each arming, until some seconds after disarming; LOG_DISARMED 1 records from the
start, in a log of its own. A vehicle that cannot record says so and drives all the same: a full card is no reason to
strand it.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import islice
from typing import Protocol

from dialects import messages as m
from dialects.enums import Severity
from link.core import RECORDER, Outgoing, Received
from link.services.ftp.files import Content, Entry, Folder, MemoryFolder, Query, ReadOnlyFolder
from link.services.ftp.protocol import FtpError
from link.services.param.values import REAL32
from vehicle.drive.control import Control
from vehicle.params import Params
from vehicle.safety.state_machine import Safety
from vehicle.statustext import StatusTextQueue

DISARM_PERSIST = 15.0
"""s of recording after disarming: what the rover did then may be why (ArduPilot's HAL_LOGGER_ARM_PERSIST)."""
PARAMS_PER_CYCLE = 4
"""Parameters that are recorded in one cycle: all of them take half a second, and no cycle takes long."""


class LogRecorder(Protocol):
    """Writes logs; vehicle.storage.recorder.VehicleRecorder is one. Nothing here blocks or raises."""

    @property
    def problem(self) -> str | None:
        """Why it does not record, or not all, in one line."""

    @property
    def folder(self) -> Folder:
        """The logs, to be served."""

    def start(self, files: int, megabytes_free: int) -> None:
        """A new log; older ones go where there are more than `files` with it, or less is free."""

    def stop(self) -> None:
        """No log from now on."""

    def tick(self, now: float) -> None:
        """Each cycle."""

    def remove_all(self) -> None:
        """Remove all logs but the one that is being written."""

    def unix_time(self, name: str) -> int:
        """Unix time of a log in s, 0 where it is not known."""


class NullLogRecorder:
    """Of a vehicle that has nowhere to record to."""

    problem: str | None = None

    def __init__(self) -> None:
        self.folder = MemoryFolder()

    def start(self, files: int, megabytes_free: int) -> None:
        """Nothing."""

    def stop(self) -> None:
        """Nothing."""

    def tick(self, now: float) -> None:
        """Nothing."""

    def remove_all(self) -> None:
        """There are none."""

    def unix_time(self, name: str) -> int:
        """There are none."""
        return 0


class Logbook:
    """Decides, each cycle."""

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

    @property
    def is_healthy(self) -> bool | None:
        """Could it record, or does it? None where it shall not."""
        if isinstance(self.recording, NullLogRecorder) or not self._params["LOG_BACKEND_TYPE"]:
            return None
        return self.recording.problem is None

    def tick(self, now: float) -> list[Outgoing]:
        """Begin, go on or end. Returns what only the log is told: all parameters, in its first moments."""
        armed = self._safety.armed
        if self._was_armed and not armed:
            self._until = now + DISARM_PERSIST
        wanted = self.is_healthy is not None and (armed or self._params["LOG_DISARMED"] or now < self._until)
        if wanted and (not self._open or (armed and not self._was_armed)):
            self._texts.reset_once(_KEY)  # each log tells anew what is wrong with it
            self.recording.start(int(self._params["LOG_MAX_FILES"]), int(self._params["LOG_FILE_MB_FREE"]))
            self._opening = self._values()
        elif self._open and not wanted:
            self.recording.stop()
        self._open, self._was_armed = bool(wanted), armed
        self.recording.tick(now)
        return [Outgoing(message, RECORDER) for message in islice(self._opening, PARAMS_PER_CYCLE)]

    def check_health(self, now: float) -> None:
        """About once a second: does it work?"""
        problem = self.recording.problem
        if problem and self.is_healthy is not None:
            self._texts.send_once(f"{_KEY} {problem}", Severity.WARNING, f"Log: {problem}", now)

    def folder(self) -> Folder:
        """The logs for MAVLink FTP, where who is in control may remove them one by one."""
        return _Logs(self.recording.folder, self._safety)

    def handle_log_erase(self, received: Received, now: float) -> None:
        """LOG_ERASE: all of them, by who is in control and while nothing drives."""
        refusal = self._control.denial_reason(received.system) or ("disarm first" if self._safety.armed else None)
        if not received.introduced:
            refusal = "its HEARTBEAT is missing"
        if refusal is None:
            self.recording.remove_all()
        text = (
            f"GCS {received.system}: logs not erased: {refusal}" if refusal else f"Logs erased by GCS {received.system}"
        )
        self._texts.send(Severity.WARNING if refusal else Severity.NOTICE, text, now)

    def _values(self) -> Iterator[m.Message]:
        count = len(self._params)
        for index, name in enumerate(self._params):
            yield m.ParamValue(name.encode(), self._params[name], REAL32, count, index)


_KEY = "recording"


class _Logs(ReadOnlyFolder):
    """Fits `ftp_files.Folder`: only read, and removed from while disarmed."""

    def __init__(self, logs: Folder, safety: Safety) -> None:
        self._logs = logs
        self._safety = safety

    def entries(self) -> Sequence[Entry]:
        return self._logs.entries()

    def open(self, name: str, query: Query) -> Content | None:
        return self._logs.open(name, query)

    def remove(self, name: str) -> FtpError | None:
        return FtpError.PROTECTED if self._safety.armed else self._logs.remove(name)
