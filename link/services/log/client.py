"""Client half of the log protocol: lists the logs of a vehicle and downloads one, for vehicles without MAVLink FTP.

The numbers of logs begin at 0 or 1. Data come in pieces of 90 bytes, gaps are requested again, and a piece that is not
full ends the log. Messages: https://mavlink.io/en/messages/common.html#LOG_REQUEST_LIST.
"""

from __future__ import annotations

import msgspec

from dialects import messages as m
from link.core import Outgoing, Received
from link.services.ftp.job import MAX_SIZE
from link.services.ftp.reassembly import FileReassembly

DATA_SIZE = 90
"""Bytes of log in one LOG_DATA."""
TIMEOUT = 0.8
"""s without an entry or data before what is missing is requested again: a 57600 baud radio takes 0.1 s for a piece."""
TRIES = 12
"""Requests in turn without anything new before a job fails: 10 s."""
MAX_LOGS = 2000
LAST = 0xFFFF
"""`end` of LOG_REQUEST_LIST: to the last log."""


class RemoteLog(msgspec.Struct, frozen=True):
    """One log, as LOG_ENTRY reports it."""

    number: int
    begun: int
    """Unix time, s; 0: not known."""
    size: int
    """Bytes; an estimate while the vehicle writes it."""


class LogOutcome(msgspec.Struct, frozen=True):
    """How a job ended."""

    log: int | None
    """Number of the log of a download; None: a list."""
    done: bool
    logs: tuple[RemoteLog, ...] = ()
    data: bytes = b""
    """Of a download; of one that failed, what arrived without a gap from the start."""
    tries: int = 0


class _Listing(msgspec.Struct):
    logs: dict[int, RemoteLog] = msgspec.field(default_factory=dict)
    total: int | None = None


class _LogDownload(msgspec.Struct):
    log: RemoteLog
    file: FileReassembly
    proof: bytes = b""
    """Last piece of what an earlier job left: requested again, because LOG_DATA has no checksum."""
    proof_at: int = 0
    request_end: int = 0
    """End of the part that was requested."""


class LogClient:
    """Talks to one vehicle, one job at a time; a new job replaces the one under way."""

    def __init__(self, system: int, component: int, *, target_system: int, target_component: int = 1) -> None:
        self._target = (target_system, target_component)
        self._job: _Listing | _LogDownload | None = None
        self._due = 0.0
        self._tries = 0
        self._outbox: list[Outgoing] = []
        self._outcomes: list[LogOutcome] = []

    def list_logs(self, now: float) -> None:
        """Request the list."""
        self._job, self._tries = _Listing(), 0
        self._request(now)

    def erase(self, now: float) -> None:
        """Erase all logs, then request the list: no message acknowledges LOG_ERASE."""
        self._send(m.LogErase(*self._target))
        self.list_logs(now)

    def download(self, log: RemoteLog, now: float, have: bytes = b"") -> None:
        """Download a log of the list; `have` is its beginning, from an earlier job.

        If the last piece of it is not that of the log, it is of another log, and the download begins anew.
        """
        at = len(have) // DATA_SIZE * DATA_SIZE - DATA_SIZE
        kept = 0 <= at < log.size
        proof = have[at : at + DATA_SIZE] if kept else b""
        job = _LogDownload(log, FileReassembly(min(log.size, MAX_SIZE)), proof, at)
        job.file.add_piece(0, have[:at] if kept else b"")
        self._job, self._tries = job, 0
        self._request(now)

    def cancel(self) -> None:
        """Cancel the job under way, without an outcome."""
        if isinstance(self._job, _LogDownload):
            self._send(m.LogRequestEnd(*self._target))
        self._job = None

    @property
    def busy(self) -> bool:
        """Whether a job is under way."""
        return self._job is not None

    @property
    def progress(self) -> tuple[int, int | None]:
        """Logs or bytes that have arrived, and all."""
        if isinstance(self._job, _LogDownload):
            return self._job.file.received.bytes, self._job.file.end
        return (len(self._job.logs), self._job.total) if self._job else (0, None)

    @property
    def holes(self) -> int:
        """Gaps in what has arrived of the download under way: lost pieces, which are requested again."""
        if not isinstance(self._job, _LogDownload):
            return 0
        received = self._job.file.received
        return sum(1 for _ in received.gaps(received.end))

    @property
    def beginning(self) -> bytes:
        """What arrived of the download under way without a gap from the start."""
        return self._job.file.beginning if isinstance(self._job, _LogDownload) else b""

    def receive(self, received: Received, now: float) -> None:
        """Handle LOG_ENTRY and LOG_DATA of the vehicle; other messages are ignored."""
        if received.system != self._target[0]:
            return
        match received.message:
            case m.LogEntry() as message if isinstance(self._job, _Listing):
                self._entry(self._job, message, now)
            case m.LogData() as message if isinstance(self._job, _LogDownload) and message.id == self._job.log.number:
                self._data(self._job, message, now)

    def tick(self, now: float) -> None:
        """Request again what is missing, and give up at last."""
        if self._job is None or now < self._due:
            return
        if self._tries >= TRIES:
            self._finish(done=False)
        else:
            self._request(now)

    def messages_to_send(self) -> list[Outgoing]:
        """Return the messages to send now, and remove them."""
        outbox, self._outbox = self._outbox, []
        return outbox

    def outcomes(self) -> list[LogOutcome]:
        """Return the jobs that ended since the last call."""
        outcomes, self._outcomes = self._outcomes, []
        return outcomes

    # ---- listing ----

    def _entry(self, job: _Listing, message: m.LogEntry, now: float) -> None:
        job.total = min(message.num_logs, MAX_LOGS)
        self._due = now + TIMEOUT
        if message.num_logs and message.id not in job.logs:
            job.logs[message.id] = RemoteLog(message.id, message.time_utc, message.size)
            self._tries = 0
        if len(job.logs) >= job.total:
            self._finish(done=True)

    # ---- downloading ----

    def _data(self, job: _LogDownload, message: m.LogData, now: float) -> None:
        before = job.file.received.bytes
        count = min(message.count, DATA_SIZE)
        piece = bytes(message.data[:count])
        if job.proof and message.ofs == job.proof_at:
            if piece != job.proof:
                self.download(job.log, now)
                return
            job.proof = b""
        job.file.add_piece(message.ofs, piece)
        if count < DATA_SIZE:
            job.file.truncate(message.ofs + count)
        if job.file.received.bytes > before:
            self._tries = 0
        self._due = now + TIMEOUT
        if job.file.complete:
            self._finish(done=True)
        elif message.ofs + count >= job.request_end:
            self._request(now)

    # ---- requests ----

    def _request(self, now: float) -> None:
        """Request the list, or the first gap of the log: a vehicle sends one part at a time."""
        self._tries += 1
        self._due = now + TIMEOUT
        if isinstance(self._job, _LogDownload):
            gap = next(self._job.file.received.gaps(self._job.file.end), None)
            if gap is None:
                self._finish(done=True)
                return
            self._job.request_end = gap[1]
            self._send(m.LogRequestData(*self._target, self._job.log.number, gap[0], gap[1] - gap[0]))
        elif self._job is not None:
            self._send(m.LogRequestList(*self._target, 0, LAST))

    def _finish(self, *, done: bool) -> None:
        job, self._job = self._job, None
        if isinstance(job, _LogDownload):
            self._send(m.LogRequestEnd(*self._target))
            data = job.file.data if done else job.file.beginning
            self._outcomes.append(LogOutcome(job.log.number, done, data=data, tries=self._tries))
        elif job is not None:
            logs = tuple(job.logs[number] for number in sorted(job.logs))
            self._outcomes.append(LogOutcome(None, done, logs, tries=self._tries))

    def _send(self, message: m.Message) -> None:
        self._outbox.append(Outgoing(message))
