"""Open files of an FTP server: whose they are, how many there may be, and when they are forgotten."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

from link.core import Peer, Received
from link.services.ftp.files import Content, Location
from link.services.ftp.protocol import FtpError

MAX_SESSIONS = 16
MAX_SESSIONS_PER_CLIENT = 4
"""Open files a client: what the known clients open is one."""
EXPIRY = 30.0
"""s without a question until an open file is forgotten: longer than a client's retries (MAVProxy's last 10 s)."""
IDLE_AFTER = 5.0
"""s after which an open file gives up its place to a client that has none."""
MAX_FILE = 256 * 1024
"""Bytes of a file that is written: a mission of 500 items as a .plan file is 150 kB."""


class FtpClientId(NamedTuple):
    """Who asks."""

    peer: Peer
    system: int
    component: int


def client_id(received: Received) -> FtpClientId:
    """Whom to answer."""
    return FtpClientId(received.peer, received.system, received.component)


@dataclass(slots=True)
class Burst:
    """Data on its way without being asked for piece by piece."""

    sequence: int
    """Of the next message."""
    offset: int
    size: int
    """Bytes a message."""
    left: int
    """Messages until the client has to ask again."""


@dataclass(slots=True)
class FtpSession:
    """A file that is open."""

    client: FtpClientId
    number: int
    last_used: float
    content: Content
    writes: Location | None = None
    """Where it goes when it is closed, for a file that is written."""
    data: bytearray | None = None
    """What was written so far."""
    burst: Burst | None = None

    def write(self, offset: int, data: bytes) -> FtpError | None:
        """Put `data` at `offset`; pieces may come in any order, what lies between them is zero."""
        if self.data is None:
            return FtpError.PROTECTED
        if offset + len(data) > MAX_FILE:
            return FtpError.FAIL
        self.data.extend(bytes(max(0, offset - len(self.data))))
        self.data[offset : offset + len(data)] = data
        return None


class FtpSessions:
    """The table of open files.

    A client gets the number it asked for, also one that it had in use: MAVSDK and MAVProxy go on with the number they
    sent, whatever the answer says, and one that asks twice has lost track of the first.
    """

    def __init__(self) -> None:
        self._open: dict[tuple[FtpClientId, int], FtpSession] = {}

    def add(self, session: FtpSession, now: float) -> FtpError | None:
        """Keep an open file; returns why not."""
        key = (session.client, session.number)
        if key not in self._open and (
            len(self.for_client(session.client)) >= MAX_SESSIONS_PER_CLIENT or not self._room(now)
        ):
            return FtpError.NO_SESSIONS
        self._open[key] = session
        return None

    def get(self, client: FtpClientId, number: int, now: float) -> FtpSession | None:
        """The open file, which counts as used now."""
        session = self._open.get((client, number))
        if session is not None:
            session.last_used = now
        return session

    def for_client(self, client: FtpClientId) -> list[FtpSession]:
        """All that a client has open."""
        return [session for session in self._open.values() if session.client == client]

    def close(self, session: FtpSession) -> None:
        """Forget it."""
        self._open.pop((session.client, session.number), None)

    def bursts(self) -> list[FtpSession]:
        """Those with data on its way."""
        return [session for session in self._open.values() if session.burst]

    def expire(self, now: float) -> None:
        """Forget what nobody has used for long. What was written is not kept: half a file is none."""
        for session in list(self._open.values()):
            if now - session.last_used >= EXPIRY:
                self.close(session)

    def _room(self, now: float) -> bool:
        """Is there a place, or one that can be made free?"""
        if len(self._open) < MAX_SESSIONS:
            return True
        oldest = min(self._open.values(), key=lambda session: session.last_used)
        if now - oldest.last_used >= IDLE_AFTER:
            self.close(oldest)
        return len(self._open) < MAX_SESSIONS
