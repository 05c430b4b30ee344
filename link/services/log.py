"""The log protocol of a vehicle: lists and sends the files of a folder, by number; it never erases them.

MAVLink FTP serves the same folder faster; this is for clients that know only LOG_REQUEST_LIST (MAVSDK, MAVProxy,
QGroundControl). Numbers begin at 0, as QGroundControl expects of all but ArduPilot.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import NamedTuple

from dialects import messages as m
from link.core import Outgoing, Peer, Received
from link.services.ftp_files import Content, Entry, Folder
from link.services.pacing import OVERHEAD, Pacer

DATA_SIZE = 90
"""Bytes of log in one LOG_DATA."""
MAX_CLIENTS = 8
MAX_WISHES = 8
"""Pieces a client may ask for at once: MAVProxy fills holes five at a time."""
MAX_LOGS = 1000
LIST_FRAME = m.LogEntry.unpacker.size + OVERHEAD
DATA_FRAME = m.LogData.unpacker.size + OVERHEAD


class _Wish(NamedTuple):
    """A part of a log that a client asked for."""

    log: int
    start: int
    end: int


@dataclass(slots=True)
class _Client:
    """What is on its way to one peer."""

    listing: deque[m.LogEntry] = field(default_factory=deque)
    wishes: deque[_Wish] = field(default_factory=deque)
    content: Content | None = None
    at: int = 0
    """The next byte of the first wish."""

    @property
    def idle(self) -> bool:
        """Is nothing on its way?"""
        return not self.listing and not self.wishes


class LogServer:
    """Answers for one system and component. `when` gives a log's Unix time in s, 0 where it is not known; `say` gets a
    line for the driver."""

    def __init__(
        self,
        logs: Folder,
        *,
        system: int,
        component: int,
        pacer: Pacer,
        when: Callable[[str], int] = lambda name: 0,
        say: Callable[[str, float], None] = lambda text, now: None,
    ) -> None:
        self._logs = logs
        self._ids = (system, component)
        self._pacer = pacer
        self._when = when
        self._say = say
        self._clients: dict[Peer, _Client] = {}

    def receive(self, received: Received, now: float) -> list[Outgoing]:
        """Take one message; nothing where it is not for us or its sender may not ask. Answers come by
        tick()."""
        message = received.message
        if not received.may_ask or getattr(message, "target_system", 0) != self._ids[0]:
            return []
        if getattr(message, "target_component", 0) not in (0, self._ids[1]):
            return []
        match message:
            case m.LogRequestList():
                self._list(message, received.peer)
            case m.LogRequestData():
                return self._want(message, received.peer)
            case m.LogRequestEnd():
                self._clients.pop(received.peer, None)
            case m.LogErase():
                self._say("Logs are not erased over the air", now)
        return []

    def tick(self, now: float) -> list[Outgoing]:
        """The next entries and data of all clients, as far as the links have room."""
        outgoing: list[Outgoing] = []
        for peer, client in list(self._clients.items()):
            while client.listing and self._pacer.take(peer, LIST_FRAME, now):
                outgoing.append(Outgoing(client.listing.popleft(), peer))
            while client.wishes and (data := self._next(client)) and self._pacer.take(peer, DATA_FRAME, now):
                outgoing.append(Outgoing(self._sent(client, data), peer))
            if client.idle:
                del self._clients[peer]
        return outgoing

    def _entries(self) -> list[Entry]:
        return [entry for entry in self._logs.entries() if entry.size is not None][:MAX_LOGS]

    def _client(self, peer: Peer) -> _Client | None:
        if peer not in self._clients and len(self._clients) >= MAX_CLIENTS:
            return None
        return self._clients.setdefault(peer, _Client())

    def _list(self, message: m.LogRequestList, peer: Peer) -> None:
        client = self._client(peer)
        if client is None:
            return
        logs = self._entries()
        last = max(0, len(logs) - 1)
        chosen = range(message.start, min(message.end, last) + 1) if logs else range(0)
        client.listing = deque(
            m.LogEntry(number, len(logs), last, self._when(logs[number].name), logs[number].size or 0)
            for number in chosen
        )
        if not logs:
            client.listing.append(m.LogEntry(0, 0, 0, 0, 0))

    def _want(self, message: m.LogRequestData, peer: Peer) -> list[Outgoing]:
        logs, client = self._entries(), self._client(peer)
        if client is None:
            return []
        if message.id >= len(logs):
            return [Outgoing(_data(message.id, message.ofs, b""), peer)]
        wish = _Wish(message.id, message.ofs, message.ofs + message.count)
        if wish not in client.wishes and len(client.wishes) < MAX_WISHES:
            client.wishes.append(wish)
        return []

    def _next(self, client: _Client) -> m.LogData | None:
        """The next data of the first wish; None while the disk has not brought it."""
        wish = client.wishes[0]
        if client.content is None:
            logs = self._entries()
            client.content = self._logs.open(logs[wish.log].name, {}) if wish.log < len(logs) else None
            client.at = wish.start
        if client.content is None:
            return _data(wish.log, wish.start, b"")
        data = client.content.read(client.at, max(0, min(DATA_SIZE, wish.end - client.at)))
        return None if data is None else _data(wish.log, client.at, data)

    @staticmethod
    def _sent(client: _Client, data: m.LogData) -> m.LogData:
        """Go on behind `data`; data that is not full ends a log, and where the last was full an empty one does."""
        client.at = data.ofs + data.count
        if data.count < DATA_SIZE or client.at >= client.wishes[0].end:
            client.wishes.popleft()
            client.content = None
        return data


def _data(log: int, offset: int, data: bytes) -> m.LogData:
    return m.LogData(log, offset, len(data), data.ljust(DATA_SIZE, b"\0"))
