"""Client half of MAVLink FTP: downloads, uploads, lists and removes files, and compares checksums.

Source: https://mavlink.io/en/services/ftp.html.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable

from msgspec.structs import replace

from dialects import messages as m
from link.core import Outgoing, Received
from link.services.ftp.download import Download
from link.services.ftp.job import MAX_SIZE, TRIES, FtpJob, FtpLine, FtpOperation, FtpOutcome, encode_path
from link.services.ftp.protocol import SEQUENCE_MASK, parse_packet
from link.services.ftp.single import ListFolderRequest, SingleRequest
from link.services.ftp.upload import Upload

JobFactory = Callable[[FtpLine, bytes], FtpJob]
"""Makes a job from its line and its encoded path."""


class FtpClient:
    """Talks to one vehicle, one job at a time in the order of the requests. Each has a number, rising from 1."""

    def __init__(
        self, system: int, component: int, *, target_system: int, target_component: int = 1, first: int = 0
    ) -> None:
        """`first`: 24 bits from which sequence and session numbers are counted.

        ArduPilot and PX4 take a request for a repeated one, and repeat their last reply, if its sender, session and
        sequence equal those of the last one: a program that begins where another began reads answers to the other's.
        """
        self._ids = (system, component)
        self._target = (target_system, target_component)
        self._sequence = first & SEQUENCE_MASK
        self._session = first >> 16 & 0xFF
        self._count = 0
        self._waiting: deque[tuple[int, bytes, JobFactory]] = deque()
        self._current: tuple[int, FtpLine, FtpJob] | None = None
        self._outbox: list[Outgoing] = []
        self._outcomes: list[FtpOutcome] = []

    # ---- jobs ----

    def download(self, path: str, now: float, *, have: bytes = b"", verify: bool = False, patience: int = TRIES) -> int:
        """Download a file, e.g. "/logs/1.bin" or "@PARAM/param.pck"; return the number of the job.

        `have`: the beginning of the file, to resume. `verify`: compare the checksum at the end. `patience`: requests
        to open it without a reply before it fails.
        """
        return self._add(
            FtpOperation.DOWNLOAD,
            path,
            now,
            lambda line, raw: Download(line, path, raw, have, verify, patience),
        )

    def upload(self, path: str, data: bytes, now: float) -> int:
        """Create or replace a file; return the number of the job."""
        if len(data) > MAX_SIZE:
            return self._refuse(FtpOperation.UPLOAD, path, f"{len(data)} bytes are more than {MAX_SIZE}")
        return self._add(FtpOperation.UPLOAD, path, now, lambda line, raw: Upload(line, path, raw, data))

    def list_folder(self, path: str, now: float) -> int:
        """List a folder; return the number of the job."""
        return self._add(FtpOperation.LIST, path, now, lambda line, raw: ListFolderRequest(line, path, raw))

    def remove(self, path: str, now: float) -> int:
        """Remove a file; return the number of the job."""
        return self._single(FtpOperation.REMOVE, path, now)

    def checksum(self, path: str, now: float) -> int:
        """Have the checksum of a file computed; return the number of the job."""
        return self._single(FtpOperation.CHECKSUM, path, now)

    def cancel(self, number: int | None = None, now: float = 0.0) -> None:
        """Cancel one job or all, without an outcome."""
        self._waiting = deque(each for each in self._waiting if number is not None and each[0] != number)
        if self._current is not None and number in (None, self._current[0]):
            self._current[2].abandon()
            self._leave()
            self._start(now)

    @property
    def busy(self) -> bool:
        """Whether a job is under way."""
        return self._current is not None

    @property
    def progress(self) -> tuple[int, int | None]:
        """Bytes of the job under way that were transferred, and all, as far as known."""
        return self._current[2].progress if self._current else (0, None)

    @property
    def beginning(self) -> bytes:
        """What arrived of the download under way without a gap from the start."""
        return self._current[2].beginning if self._current and isinstance(self._current[2], Download) else b""

    @property
    def holes(self) -> int:
        """Gaps in what has arrived of the download under way: lost pieces, which are requested again."""
        return self._current[2].holes if self._current and isinstance(self._current[2], Download) else 0

    @property
    def number(self) -> int | None:
        """Number of the job under way."""
        return self._current[0] if self._current else None

    # ---- core ----

    def receive(self, received: Received, now: float) -> None:
        """Handle a reply of the vehicle; other messages are ignored."""
        message = received.message
        if self._current is None or not isinstance(message, m.FileTransferProtocol):
            return
        if received.system != self._target[0] or message.target_system != self._ids[0]:
            return
        if message.target_component in (0, self._ids[1]):
            self._current[2].receive(parse_packet(message), now)
            self._advance(now)

    def tick(self, now: float) -> None:
        """Repeat overdue requests, and give up at last."""
        if self._current is not None:
            self._current[2].tick(now)
            self._advance(now)

    def messages_to_send(self) -> list[Outgoing]:
        """Return the messages to send now, and remove them."""
        self._collect()
        outbox, self._outbox = self._outbox, []
        return outbox

    def outcomes(self) -> list[FtpOutcome]:
        """Return the jobs that ended since the last call."""
        outcomes, self._outcomes = self._outcomes, []
        return outcomes

    # ---- the queue ----

    def _single(self, job: FtpOperation, path: str, now: float) -> int:
        return self._add(job, path, now, lambda line, raw: SingleRequest(line, path, raw, job))

    def _add(self, job: FtpOperation, path: str, now: float, factory: JobFactory) -> int:
        raw = encode_path(path)
        if raw is None:
            return self._refuse(job, path, "the path is empty or too long")
        self._count += 1
        self._waiting.append((self._count, raw, factory))
        self._start(now)
        return self._count

    def _refuse(self, job: FtpOperation, path: str, problem: str) -> int:
        self._count += 1
        self._outcomes.append(FtpOutcome(job, path, False, problem=problem, number=self._count))
        return self._count

    def _start(self, now: float) -> None:
        """Begin the next job, in a session of its own: late data of the last is not taken for this one's."""
        if self._current is not None or not self._waiting:
            return
        number, raw, factory = self._waiting.popleft()
        self._session = (self._session + 1) & 0xFF
        line = FtpLine(self._target, self._session, self._sequence)
        self._current = (number, line, factory(line, raw))
        self._current[2].begin(now)

    def _advance(self, now: float) -> None:
        """Report a job that has ended, and begin the next."""
        if self._current is None or self._current[2].outcome is None:
            return
        self._outcomes.append(replace(self._current[2].outcome, number=self._current[0]))
        self._leave()
        self._start(now)

    def _leave(self) -> None:
        self._collect()
        self._current = None

    def _collect(self) -> None:
        if self._current is not None:
            _, line, _ = self._current
            self._sequence = line.sequence
            self._outbox += line.outbox
            line.outbox.clear()
