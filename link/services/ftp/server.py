"""The vehicle's half of MAVLink FTP: answers every question about a tree of files, and never touches any other.

Rules (mavlink.io/en/services/ftp.html): each question gets one ACK or NAK with its sequence plus one; a question that
was repeated gets the stored answer and has no second effect; reading is for everybody, writing for who is allowed and
only where a folder takes it. A burst is a run of answers, paced by the link. Its last message says so, at the end of
the file too: MAVSDK takes an END_OF_FILE that it did not ask for as a failure.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeVar

from dialects import messages as m
from link.core import Outgoing, Received
from link.services.ftp.files import FileTree
from link.services.ftp.handlers import FtpHandlers, FtpRequest
from link.services.ftp.protocol import MAX_DATA, SEQUENCE_MASK, FtpError, FtpOpcode, FtpPacket, parse_packet
from link.services.ftp.sessions import Burst, FtpClientId, FtpSession, FtpSessions, client_id
from link.services.pacing import MAVLINK2_OVERHEAD, BulkPacer

BURST_LENGTH = 200
"""Messages until a client must ask again: 48 kB, so that one who has gone costs no more."""
MAX_CLIENTS = 16
"""Stored answers, and questions that wait; the oldest is forgotten."""
FRAME_OVERHEAD = m.FileTransferProtocol.unpacker.size - MAX_DATA + MAVLINK2_OVERHEAD
"""Bytes of a frame around its data."""
_Value = TypeVar("_Value")
_CLOSING = (FtpOpcode.TERMINATE, FtpOpcode.RESET)
"""What is closed cannot be asked again how its writing went."""
_OPENING = (FtpOpcode.OPEN, FtpOpcode.CREATE, FtpOpcode.OPEN_TO_WRITE)


class FtpServer:
    """Answers for one system and component. `allowed` says who may write."""

    def __init__(
        self,
        tree: FileTree,
        *,
        system: int,
        component: int,
        pacer: BulkPacer,
        allowed: Callable[[Received], bool] = lambda received: True,
    ) -> None:
        self._ids = (system, component)
        self._pacer = pacer
        self._allowed = allowed
        self._sessions = FtpSessions()
        self._answers = FtpHandlers(tree, self._sessions)
        self._waiting: dict[FtpClientId, FtpRequest] = {}
        self._answered: dict[FtpClientId, tuple[FtpPacket, Outgoing]] = {}

    def receive(self, received: Received, now: float) -> list[Outgoing]:
        """Answer one message; nothing where it is not for us or its sender may not ask."""
        message = received.message
        if not isinstance(message, m.FileTransferProtocol) or not received.may_ask:
            return []
        if message.target_system != self._ids[0] or message.target_component not in (0, self._ids[1]):
            return []
        request, client = parse_packet(message), client_id(received)
        if request.op in (FtpOpcode.ACK, FtpOpcode.NAK):
            return []
        again = self._said_again(client, request, now)
        return again or self._attempt(FtpRequest(client, request, received.introduced and self._allowed(received)), now)

    def tick(self, now: float) -> list[Outgoing]:
        """Go on with bursts and with what had to wait; forget what is too old."""
        self._sessions.expire(now)
        outgoing: list[Outgoing] = []
        for question in list(self._waiting.values()):
            outgoing += self._attempt(question, now)
        for session in self._sessions.bursts():
            outgoing += self._burst(session, now)
        return outgoing

    def _said_again(self, client: FtpClientId, request: FtpPacket, now: float) -> list[Outgoing]:
        """The stored answer to the same question. To be the same, all of it must be: a client that starts anew begins
        with the same sequence numbers. And a file that it opened must be open still.
        """
        before = self._answered.get(client)
        if before is None or before[0] != request:
            return []
        if request.op in _OPENING and self._sessions.get(client, request.session, now) is None:
            return []
        return [before[1]]

    def _attempt(self, question: FtpRequest, now: float) -> list[Outgoing]:
        """Answer, or keep the question for the next tick. A client's newer question takes the place of its older."""
        self._waiting.pop(question.client, None)
        if question.request.op == FtpOpcode.BURST:
            fault = self._begin_burst(question.client, question.request, now)
            return [_nak(question, fault)] if fault else []
        answer = self._answers.handle(question, now)
        if answer is None:
            _keep(self._waiting, question.client, question)
            return []
        outgoing = _nak(question, answer) if isinstance(answer, FtpError) else _ack(question, answer)
        if not isinstance(answer, FtpError) or question.request.op in _CLOSING:
            _keep(self._answered, question.client, (question.request, outgoing))
        return [outgoing]

    def _begin_burst(self, client: FtpClientId, request: FtpPacket, now: float) -> FtpError | None:
        """Asked again, it begins anew from where it is asked for: a client that lost something repeats its question
        with the same sequence and another offset.
        """
        session = self._sessions.get(client, request.session, now)
        if session is None or session.data is not None:
            return FtpError.INVALID_SESSION
        session.burst = None
        if (request.size or 0) > MAX_DATA:
            return FtpError.INVALID_SIZE
        if request.offset >= session.content.size:
            return FtpError.END_OF_FILE
        first = (request.sequence + 1) & SEQUENCE_MASK
        session.burst = Burst(first, request.offset, request.size or MAX_DATA, BURST_LENGTH)
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
    """The next message of a burst; ends the burst after its last."""
    end = burst.offset + len(data)
    complete = end >= session.content.size or burst.left <= 1
    packet = FtpPacket(burst.sequence, FtpOpcode.ACK, session.number, data, burst.offset, FtpOpcode.BURST, complete)
    burst.sequence, burst.offset, burst.left = (burst.sequence + 1) & SEQUENCE_MASK, end, burst.left - 1
    if complete:
        session.burst = None
    return _to(session.client, packet)


def _gone(session: FtpSession, burst: Burst) -> Outgoing:
    """The file has ended before its size: somebody removed it."""
    session.burst = None
    return _to(
        session.client,
        FtpPacket(burst.sequence, FtpOpcode.NAK, session.number, bytes([FtpError.FAIL]), 0, FtpOpcode.BURST),
    )


def _ack(question: FtpRequest, data: bytes) -> Outgoing:
    return _reply(question, FtpOpcode.ACK, data)


def _nak(question: FtpRequest, error: FtpError) -> Outgoing:
    return _reply(question, FtpOpcode.NAK, bytes([error]))


def _reply(question: FtpRequest, op: FtpOpcode, data: bytes) -> Outgoing:
    request = question.request
    sequence = (request.sequence + 1) & SEQUENCE_MASK
    return _to(question.client, FtpPacket(sequence, op, request.session, data, request.offset, request.op))


def _to(client: FtpClientId, packet: FtpPacket) -> Outgoing:
    return Outgoing(packet.message(client.system, client.component), client.peer)


def _keep(table: dict[FtpClientId, _Value], client: FtpClientId, value: _Value) -> None:
    """Put the newest last, and forget the oldest where there are too many."""
    table.pop(client, None)
    table[client] = value
    if len(table) > MAX_CLIENTS:
        del table[next(iter(table))]
