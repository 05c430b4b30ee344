"""Sessions of an FTP server: open files by client, their limits and expiry."""

from __future__ import annotations

from typing import NamedTuple

import msgspec

from link.core import Peer, Received
from link.services.ftp.files import Content, Location
from link.services.ftp.protocol import FtpError

MAX_SESSIONS = 16
MAX_SESSIONS_PER_CLIENT = 4
"""Open files of one client: known clients open one."""
EXPIRY = 30.0
"""s without a request until an open file is closed: longer than a client repeats (MAVProxy's last after 10 s)."""
IDLE_AFTER = 5.0
"""s without a request after which an open file may be closed in favour of a client that has none."""
MAX_FILE = 256 * 1024
"""Bytes of a written file: a mission of 500 items as a .plan file has 150 kB."""


class FtpClientId(NamedTuple):
    """A client, and where to reply."""

    peer: Peer
    system: int
    component: int


def client_id(received: Received) -> FtpClientId:
    """Return the client of a message."""
    return FtpClientId(received.peer, received.system, received.component)


class Burst(msgspec.Struct):
    """A burst under way."""

    sequence: int
    """Sequence of the next message."""
    offset: int
    size: int
    """Bytes per message."""
    left: int
    """Messages until the client has to request more."""


class FtpSession(msgspec.Struct):
    """An open file."""

    client: FtpClientId
    number: int
    last_used: float
    content: Content
    writes: Location | None = None
    """Where a written file is stored on close."""
    data: bytearray | None = None
    """What was written so far."""
    burst: Burst | None = None
    was_burst: bool = False
    """A burst was requested: what is read piece by piece after that was lost."""

    def write(self, offset: int, data: bytes) -> FtpError | None:
        """Write `data` at `offset`. Pieces may come in any order; gaps are zero."""
        if self.data is None:
            return FtpError.PROTECTED
        if offset + len(data) > MAX_FILE:
            return FtpError.FAIL
        self.data.extend(bytes(max(0, offset - len(self.data))))
        self.data[offset : offset + len(data)] = data
        return None


class FtpSessions:
    """The table of open files.

    A client gets the session number that it requested, even one that it has in use: MAVSDK and MAVProxy continue with
    the number they sent, whatever the reply says, and a client that opens twice has lost track of the first.
    """

    def __init__(self) -> None:
        self._open: dict[tuple[FtpClientId, int], FtpSession] = {}

    def add(self, session: FtpSession, now: float) -> FtpError | None:
        """Add an open file; return an error or None."""
        key = (session.client, session.number)
        if key not in self._open and (
            len(self.for_client(session.client)) >= MAX_SESSIONS_PER_CLIENT or not self._room(now)
        ):
            return FtpError.NO_SESSIONS
        self._open[key] = session
        return None

    def get(self, client: FtpClientId, number: int, now: float) -> FtpSession | None:
        """Return the open file, and count it as used now."""
        session = self._open.get((client, number))
        if session is not None:
            session.last_used = now
        return session

    def for_client(self, client: FtpClientId) -> list[FtpSession]:
        """Return all open files of a client."""
        return [session for session in self._open.values() if session.client == client]

    def move(self, client: FtpClientId, to: FtpClientId) -> None:
        """Let the open files of a client be those of another one: it is the same on another link."""
        for session in self.for_client(client):
            self.close(session)
            session.client = to
            self._open[to, session.number] = session

    def close(self, session: FtpSession) -> None:
        """Remove a session."""
        self._open.pop((session.client, session.number), None)

    def bursts(self) -> list[FtpSession]:
        """Return the sessions with a burst."""
        return [session for session in self._open.values() if session.burst]

    def expire(self, now: float) -> None:
        """Close files without a request for EXPIRY. Written data is dropped: half a file is useless."""
        for session in list(self._open.values()):
            if now - session.last_used >= EXPIRY:
                self.close(session)

    def _room(self, now: float) -> bool:
        """Return whether there is room, if need be by closing an idle file."""
        if len(self._open) < MAX_SESSIONS:
            return True
        oldest = min(self._open.values(), key=lambda session: session.last_used)
        if now - oldest.last_used >= IDLE_AFTER:
            self.close(oldest)
        return len(self._open) < MAX_SESSIONS
