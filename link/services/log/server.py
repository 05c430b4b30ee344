"""Server half of the log protocol: lists, sends and erases the files of a folder, by number.

MAVLink FTP serves the same folder faster; this is for clients that use only LOG_REQUEST_LIST (MAVSDK, MAVProxy,
QGroundControl). Numbers begin at 0, as QGroundControl expects of all vehicles but ArduPilot's. For each client they
refer to the last list that it requested, because the folder may have changed since. Messages:
https://mavlink.io/en/messages/common.html#LOG_REQUEST_LIST.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterator
from contextlib import suppress
from typing import NamedTuple

import msgspec

from dialects import messages as m
from link.core import Outgoing, Peer, Received
from link.services.ftp.files import Content, DirectoryEntry, Folder, NotReadyError
from link.services.pacing import MAVLINK2_OVERHEAD, BulkPacer

DATA_SIZE = 90
"""Bytes of log in one LOG_DATA."""
MAX_CLIENTS = 8
MAX_REQUESTS = 8
"""Requests a client may have open: MAVProxy fills gaps five at a time."""
MAX_LOGS = 1000
LIST_FRAME = m.LogEntry.unpacker.size + MAVLINK2_OVERHEAD
DATA_FRAME = m.LogData.unpacker.size + MAVLINK2_OVERHEAD


class _DataRequest(NamedTuple):
    """A part of a log that a client requested."""

    log: int
    start: int
    end: int


class _LogClient(msgspec.Struct):
    """Transfers to one peer."""

    logs: list[DirectoryEntry] | None = None
    """The last list that was sent; None before the first request."""
    list_from: int | None = None
    """First entry of the requested list; `list_to` is the last."""
    list_to: int = 0
    listing: deque[m.LogEntry] = msgspec.field(default_factory=deque)
    requests: deque[_DataRequest] = msgspec.field(default_factory=deque)
    content: Content | None = None
    at: int = 0
    """Next byte of the first request."""

    @property
    def idle(self) -> bool:
        """Whether no transfer is under way."""
        return self.list_from is None and not self.listing and not self.requests


class LogServer:
    """Answers for one system and component.

    `when` returns a log's Unix time in s, 0 where not known; `erase` gets every request to erase all logs.
    """

    def __init__(
        self,
        logs: Folder,
        *,
        system: int,
        component: int,
        pacer: BulkPacer,
        when: Callable[[str], int] = lambda name: 0,
        erase: Callable[[Received, float], None] = lambda received, now: None,
    ) -> None:
        self._logs = logs
        self._ids = (system, component)
        self._pacer = pacer
        self._when = when
        self._erase = erase
        self._clients: dict[Peer, _LogClient] = {}

    def receive(self, received: Received, now: float) -> list[Outgoing]:
        """Handle one message, if it is for us and its sender may ask. tick() returns all replies."""
        message = received.message
        if not received.may_ask or getattr(message, "target_system", 0) != self._ids[0]:
            return []
        if getattr(message, "target_component", 0) not in (0, self._ids[1]):
            return []
        match message:
            case m.LogRequestList() if client := self._client(received.peer):
                client.list_from, client.list_to = message.start, message.end
            case m.LogRequestData() if client := self._client(received.peer):
                request = _DataRequest(message.id, message.ofs, message.ofs + message.count)
                if request not in client.requests and len(client.requests) < MAX_REQUESTS:
                    client.requests.append(request)
            case m.LogRequestEnd() if client := self._clients.get(received.peer):
                self._clients[received.peer] = _LogClient(client.logs)
            case m.LogErase():
                self._erase(received, now)
        return []

    def tick(self, now: float) -> list[Outgoing]:
        """Return the next entries and data of all clients, as far as disk and links allow."""
        outgoing: list[Outgoing] = []
        for peer, client in self._clients.items():
            if not client.idle:
                outgoing += [Outgoing(message, peer) for message in self._next_messages(peer, client, now)]
        return outgoing

    def _next_messages(self, peer: Peer, client: _LogClient, now: float) -> Iterator[m.Message]:
        with suppress(NotReadyError):
            self._build_list(client)
            while client.listing and self._pacer.consume(peer, LIST_FRAME, now):
                yield client.listing.popleft()
            while client.requests and (data := self._next_data(client)) and self._pacer.consume(peer, DATA_FRAME, now):
                yield self._sent(client, data)

    def _entries(self) -> list[DirectoryEntry]:
        return [entry for entry in self._logs.entries() if entry.size is not None][:MAX_LOGS]

    def _client(self, peer: Peer) -> _LogClient | None:
        """Return the client's transfers, if need be in the place of an idle client; None if all are busy."""
        if peer not in self._clients and len(self._clients) >= MAX_CLIENTS:
            leaving = next((each for each, client in self._clients.items() if client.idle), None)
            if leaving is None:
                return None
            del self._clients[leaving]
        return self._clients.setdefault(peer, _LogClient())

    def _build_list(self, client: _LogClient) -> None:
        """Build the requested list. Only a list from 0 renumbers: a part of one fills what got lost."""
        start = client.list_from
        if start is None:
            return
        logs = client.logs = self._entries() if start == 0 or client.logs is None else client.logs
        client.list_from = None
        last = max(0, len(logs) - 1)
        chosen = range(start, min(client.list_to, last) + 1) if logs else range(0)
        client.listing = deque(
            m.LogEntry(number, len(logs), last, self._when(logs[number].name), logs[number].size or 0)
            for number in chosen
        )
        if not logs:
            client.listing.append(m.LogEntry(0, 0, 0, 0, 0))

    def _next_data(self, client: _LogClient) -> m.LogData | None:
        """Return the next data of the first request; None while it is not read. Raises NotReadyError."""
        request = client.requests[0]
        if client.content is None:
            client.content, client.at = self._open(client, request.log), request.start
        if client.content is None:
            return _data(request.log, request.start, b"")
        data = client.content.read(client.at, max(0, min(DATA_SIZE, request.end - client.at)))
        return None if data is None else _data(request.log, client.at, data)

    def _open(self, client: _LogClient, number: int) -> Content | None:
        logs = client.logs = self._entries() if client.logs is None else client.logs
        return self._logs.open(logs[number].name, {}) if number < len(logs) else None

    @staticmethod
    def _sent(client: _LogClient, data: m.LogData) -> m.LogData:
        """Advance behind `data`. Data that is not full ends a log; after a last full one an empty one does."""
        client.at = data.ofs + data.count
        if data.count < DATA_SIZE or client.at >= client.requests[0].end:
            client.requests.popleft()
            client.content = None
        return data


def _data(log: int, offset: int, data: bytes) -> m.LogData:
    return m.LogData(log, offset, len(data), data.ljust(DATA_SIZE, b"\0"))
