"""Server half of MAVLink FTP: serves a tree of files, and nothing else of the file system.

Rules (https://mavlink.io/en/services/ftp.html): each request gets one ACK or NAK with its sequence plus one. A repeated
request gets the stored reply and has no second effect. Anyone may read; clients that are allowed to may write, where a
folder accepts it. A burst is a series of replies, paced by the link. Its last message is marked as such, at the end of
the file too: MAVSDK takes an END_OF_FILE that it did not request for a failure.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeVar

from dialects import messages as m
from dialects.codec import MAX_FRAME
from link.core import OtherPeers, Outgoing, Received
from link.services.ftp.files import FileTree
from link.services.ftp.handlers import FtpHandlers, FtpRequest
from link.services.ftp.protocol import MAX_DATA, SEQUENCE_MASK, FtpError, FtpOpcode, FtpPacket, parse_packet
from link.services.ftp.sessions import Burst, FtpClientId, FtpSession, FtpSessions, client_id
from link.services.pacing import MAVLINK2_OVERHEAD, BulkPacer

BURST_LENGTH = 200
"""Messages until a client must request more: 48 kB, so that a client that has gone costs no more."""
BURST_TIME = 0.25
"""s of a fast link that a burst takes at least: between two bursts a control cycle passes."""
MAX_CLIENTS = 16
"""Stored replies, and requests that wait; the oldest is dropped."""
FRAME_OVERHEAD = m.FileTransferProtocol.unpacker.size - MAX_DATA + MAVLINK2_OVERHEAD
"""Bytes of a frame around its data."""
_Value = TypeVar("_Value")
_CLOSING = (FtpOpcode.TERMINATE, FtpOpcode.RESET)
"""Their errors are stored as well: after a close the client cannot find out in another way whether a write failed."""
_OPENING = (FtpOpcode.OPEN, FtpOpcode.CREATE, FtpOpcode.OPEN_TO_WRITE)


class FtpServer:
    """Answers for one system and component.

    `allowed` returns whether the sender may write; while it returns None the sender is not answered, and repeats.
    `other_peers` returns where else the sender is: over several links it is one client.
    """

    def __init__(
        self,
        tree: FileTree,
        *,
        system: int,
        component: int,
        pacer: BulkPacer,
        allowed: Callable[[Received, float], bool | None] = lambda received, now: True,
        other_peers: OtherPeers = lambda received, now: (),
    ) -> None:
        self._ids = (system, component)
        self._pacer = pacer
        self._allowed, self._other_peers = allowed, other_peers
        self._sessions = FtpSessions()
        self._handlers = FtpHandlers(tree, self._sessions)
        self._waiting: dict[FtpClientId, FtpRequest] = {}
        self._stored_replies: dict[FtpClientId, tuple[FtpPacket, Outgoing]] = {}

    def receive(self, received: Received, now: float) -> list[Outgoing]:
        """Answer one message; nothing if it is not for us or its sender may not ask."""
        message = received.message
        if not isinstance(message, m.FileTransferProtocol) or not received.may_ask:
            return []
        if message.target_system != self._ids[0] or message.target_component not in (0, self._ids[1]):
            return []
        packet, client = parse_packet(message), client_id(received)
        if packet.op in (FtpOpcode.ACK, FtpOpcode.NAK):
            return []
        for peer in self._other_peers(received, now):
            self._move(client._replace(peer=peer), client)
        again = self._stored_reply(client, packet, now)
        allowed = self._allowed(received, now) if received.introduced else False
        return again or self._attempt(FtpRequest(client, packet, allowed), now)

    def tick(self, now: float) -> list[Outgoing]:
        """Continue bursts and waiting requests; drop what is too old."""
        self._sessions.expire(now)
        outgoing: list[Outgoing] = []
        for request in list(self._waiting.values()):
            outgoing += self._attempt(request, now)
        for session in self._sessions.bursts():
            outgoing += self._burst(session, now)
        return outgoing

    def _move(self, client: FtpClientId, to: FtpClientId) -> None:
        """Go on with a client on another link."""
        self._sessions.move(client, to)
        if stored := self._stored_replies.pop(client, None):
            self._stored_replies[to] = (stored[0], stored[1]._replace(peer=to.peer))
        if request := self._waiting.pop(client, None):
            request.client = to
            self._waiting[to] = request

    def _stored_reply(self, client: FtpClientId, packet: FtpPacket, now: float) -> list[Outgoing]:
        """Return the stored reply to a repeated request.

        The whole request must be equal, because a restarted client begins with the same sequence numbers; and a file
        that it opened must still be open.
        """
        before = self._stored_replies.get(client)
        if before is None or before[0] != packet:
            return []
        if packet.op in _OPENING and self._sessions.get(client, packet.session, now) is None:
            return []
        return [before[1]]

    def _attempt(self, request: FtpRequest, now: float) -> list[Outgoing]:
        """Reply, or keep the request for the next tick. A client's newer request replaces its older one."""
        self._waiting.pop(request.client, None)
        if request.packet.op == FtpOpcode.BURST:
            fault = self._begin_burst(request.client, request.packet, now)
            return [_nak(request, fault)] if fault else []
        if request.packet.op == FtpOpcode.READ:
            session = self._sessions.get(request.client, request.packet.session, now)
            if session is not None and session.was_burst:
                self._pacer.note_loss(request.client.peer)
        answer = self._handlers.handle(request, now)
        if answer is None:
            _keep(self._waiting, request.client, request)
            return []
        outgoing = _nak(request, answer) if isinstance(answer, FtpError) else _ack(request, answer)
        if not isinstance(answer, FtpError) or request.packet.op in _CLOSING:
            _keep(self._stored_replies, request.client, (request.packet, outgoing))
        return [outgoing]

    def _begin_burst(self, client: FtpClientId, packet: FtpPacket, now: float) -> FtpError | None:
        """Start a burst at the requested offset, also during another one.

        A client that has lost data repeats its request with the same sequence and another offset.
        """
        session = self._sessions.get(client, packet.session, now)
        if session is None or session.data is not None:
            return FtpError.INVALID_SESSION
        session.burst = None
        if (packet.size or 0) > MAX_DATA:
            return FtpError.INVALID_SIZE
        if packet.offset >= session.content.size:
            return FtpError.END_OF_FILE
        first = (packet.sequence + 1) & SEQUENCE_MASK
        session.was_burst = True
        messages = max(BURST_LENGTH, int(self._pacer.rate(client.peer) * BURST_TIME / MAX_FRAME))
        session.burst = Burst(first, packet.offset, packet.size or MAX_DATA, messages)
        return None

    def _burst(self, session: FtpSession, now: float) -> list[Outgoing]:
        outgoing: list[Outgoing] = []
        while session.burst:
            data = session.content.read(session.burst.offset, session.burst.size)
            if data == b"":
                outgoing.append(_gone(session, session.burst))
                break
            if not data or not self._pacer.consume(session.client.peer, FRAME_OVERHEAD + len(data), now):
                break
            session.last_used = now
            outgoing.append(_piece(session, session.burst, data))
        return outgoing


def _piece(session: FtpSession, burst: Burst, data: bytes) -> Outgoing:
    """Return the next message of a burst; end the burst after its last."""
    end = burst.offset + len(data)
    complete = end >= session.content.size or burst.left <= 1
    packet = FtpPacket(burst.sequence, FtpOpcode.ACK, session.number, data, burst.offset, FtpOpcode.BURST, complete)
    burst.sequence, burst.offset, burst.left = (burst.sequence + 1) & SEQUENCE_MASK, end, burst.left - 1
    if complete:
        session.burst = None
    return _to(session.client, packet)


def _gone(session: FtpSession, burst: Burst) -> Outgoing:
    """End a burst with FAIL: the file has ended before its size, because it was removed."""
    session.burst = None
    return _to(
        session.client,
        FtpPacket(burst.sequence, FtpOpcode.NAK, session.number, bytes([FtpError.FAIL]), 0, FtpOpcode.BURST),
    )


def _ack(request: FtpRequest, data: bytes) -> Outgoing:
    return _reply(request, FtpOpcode.ACK, data)


def _nak(request: FtpRequest, error: FtpError) -> Outgoing:
    return _reply(request, FtpOpcode.NAK, bytes([error]))


def _reply(request: FtpRequest, op: FtpOpcode, data: bytes) -> Outgoing:
    packet = request.packet
    sequence = (packet.sequence + 1) & SEQUENCE_MASK
    return _to(request.client, FtpPacket(sequence, op, packet.session, data, packet.offset, packet.op))


def _to(client: FtpClientId, packet: FtpPacket) -> Outgoing:
    return Outgoing(packet.message(client.system, client.component), client.peer)


def _keep(table: dict[FtpClientId, _Value], client: FtpClientId, value: _Value) -> None:
    """Store a value as the newest, and drop the oldest if there are too many."""
    table.pop(client, None)
    table[client] = value
    if len(table) > MAX_CLIENTS:
        del table[next(iter(table))]
