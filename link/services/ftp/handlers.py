"""What each FTP question does to the tree and to the open files, and its answer; how it travels is server.py."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from link.services.ftp.files import BytesContent, Content, Entry, FileTree, Location, NotReadyError
from link.services.ftp.protocol import MAX_DATA, FtpError, FtpOpcode, FtpPacket, crc32
from link.services.ftp.sessions import FtpClientId, FtpSession, FtpSessions

CRC_PIECE = 64 * 1024
"""Bytes that go into a checksum in one tick: 0.1 ms on a Raspberry Pi."""

FtpReply = bytes | FtpError | None
"""Data of an ACK, the error of a NAK, or None: ask again at the next tick."""


@dataclass(slots=True)
class FtpRequest:
    """A request, and how far its answer has come where that takes more than one tick."""

    client: FtpClientId
    request: FtpPacket
    allowed: bool
    """May this client write?"""
    content: Content | None = None
    crc: int = 0
    offset: int = 0


class FtpHandlers:
    """Answers all questions but bursts."""

    def __init__(self, tree: FileTree, sessions: FtpSessions) -> None:
        self._tree = tree
        self._sessions = sessions

    def handle(self, question: FtpRequest, now: float) -> FtpReply:
        """Do what is asked."""
        if (question.request.size or 0) > MAX_DATA:
            return FtpError.INVALID_SIZE
        handler = _HANDLERS.get(question.request.op)
        try:
            return handler(self, question, now) if handler else FtpError.UNKNOWN_COMMAND
        except NotReadyError:
            return None

    # ---- sessions ----

    def _none(self, question: FtpRequest, now: float) -> FtpReply:
        return b""

    def _terminate(self, question: FtpRequest, now: float) -> FtpReply:
        """Closing what is not open is no error: MAVSDK closes after a listing, and an answer may have been lost."""
        session = self._sessions.get(question.client, question.request.session, now)
        return b"" if session is None else self._close(session)

    def _reset(self, question: FtpRequest, now: float) -> FtpReply:
        """Close all that this client has open; what others have open is not its business."""
        faults = [self._close(session) for session in self._sessions.for_client(question.client)]
        return next((fault for fault in faults if fault), b"")

    def _close(self, session: FtpSession) -> bytes | FtpError:
        """A written file counts when it is closed; QGroundControl closes it by a reset."""
        fault = None
        if session.writes is not None and session.data is not None:
            fault = session.writes.folder.store(session.writes.name, bytes(session.data))
        self._sessions.close(session)
        return fault or b""

    # ---- reading ----

    def _list(self, question: FtpRequest, now: float) -> FtpReply:
        place = self._tree.find(question.request.data)
        if place is None or place.name:
            return FtpError.NOT_FOUND
        packed = b""
        for entry in self._tree.listing(place.folder)[question.request.offset :]:
            line = _line(entry)
            if len(packed) + len(line) > MAX_DATA:
                break
            packed += line
        return packed or FtpError.END_OF_FILE

    def _open(self, question: FtpRequest, now: float) -> FtpReply:
        content = self._find(question)
        if content is None:
            return FtpError.NOT_FOUND
        session = FtpSession(question.client, question.request.session, now, content)
        return self._sessions.add(session, now) or content.size.to_bytes(4, "little")

    def _read(self, question: FtpRequest, now: float) -> FtpReply:
        request = question.request
        session = self._sessions.get(question.client, request.session, now)
        if session is None or session.data is not None:
            return FtpError.INVALID_SESSION
        if request.offset >= session.content.size:
            return FtpError.END_OF_FILE
        data = session.content.read(request.offset, request.size or MAX_DATA)
        return FtpError.FAIL if data == b"" else data  # empty: it is gone

    def _crc(self, question: FtpRequest, now: float) -> FtpReply:
        content = question.content = question.content or self._find(question)
        if content is None:
            return FtpError.NOT_FOUND
        piece = content.read(question.offset, CRC_PIECE)
        if piece == b"" and question.offset < content.size:
            return FtpError.FAIL  # it is gone
        if piece is not None:
            question.crc, question.offset = crc32(piece, question.crc), question.offset + len(piece)
        return question.crc.to_bytes(4, "little") if question.offset >= content.size else None

    def _find(self, question: FtpRequest) -> Content | None:
        place = self._tree.find(question.request.data)
        return place.folder.open(place.name, place.query) if place and place.name else None

    # ---- writing ----

    def _create(self, question: FtpRequest, now: float) -> FtpReply:
        place = self._writable(question)
        if isinstance(place, FtpError):
            return place
        return self._begin_writing(question, place, bytearray(), now)

    def _open_to_write(self, question: FtpRequest, now: float) -> FtpReply:
        found = self._existing(question)
        if isinstance(found, FtpError):
            return found
        place, content = found
        data = content.read(0, content.size)
        return None if data is None else self._begin_writing(question, place, bytearray(data), now)

    def _begin_writing(self, question: FtpRequest, place: Location, data: bytearray, now: float) -> FtpReply:
        session = FtpSession(question.client, question.request.session, now, BytesContent(b""), place, data)
        return self._sessions.add(session, now) or b""

    def _write(self, question: FtpRequest, now: float) -> FtpReply:
        request = question.request
        session = self._sessions.get(question.client, request.session, now)
        if session is None:
            return FtpError.INVALID_SESSION
        return session.write(request.offset, request.data) or b""

    def _truncate(self, question: FtpRequest, now: float) -> FtpReply:
        found = self._existing(question)
        if isinstance(found, FtpError):
            return found
        place, content = found
        data = content.read(0, min(question.request.offset, content.size))
        return None if data is None else place.folder.store(place.name, data) or b""

    def _remove(self, question: FtpRequest, now: float) -> FtpReply:
        """A folder that is not written may still let files go, as logs."""
        place = self._tree.find(question.request.data)
        if place is None or not place.name or place.query:
            return FtpError.NOT_FOUND
        return (place.folder.remove(place.name) if question.allowed else FtpError.PROTECTED) or b""

    def _protected(self, question: FtpRequest, now: float) -> FtpReply:
        """The tree has the shape it has."""
        return FtpError.PROTECTED

    def _writable(self, question: FtpRequest) -> Location | FtpError:
        place = self._tree.find(question.request.data)
        if place is None or not place.name or place.query:
            return FtpError.NOT_FOUND
        return place if place.folder.writable(place.name) and question.allowed else FtpError.PROTECTED

    def _existing(self, question: FtpRequest) -> tuple[Location, Content] | FtpError:
        """Return the file that the client may write, and what it holds."""
        place = self._writable(question)
        if isinstance(place, FtpError):
            return place
        content = place.folder.open(place.name, {})
        return FtpError.NOT_FOUND if content is None else (place, content)


def _line(entry: Entry) -> bytes:
    """A line of a listing: F, name, tab, size; or D and name."""
    text = f"D{entry.name}" if entry.size is None else f"F{entry.name}\t{entry.size}"
    return text.encode("ascii", "replace") + b"\0"


_HANDLERS: dict[int, Callable[[FtpHandlers, FtpRequest, float], FtpReply]] = {
    FtpOpcode.NONE: FtpHandlers._none,
    FtpOpcode.TERMINATE: FtpHandlers._terminate,
    FtpOpcode.RESET: FtpHandlers._reset,
    FtpOpcode.LIST: FtpHandlers._list,
    FtpOpcode.OPEN: FtpHandlers._open,
    FtpOpcode.READ: FtpHandlers._read,
    FtpOpcode.CREATE: FtpHandlers._create,
    FtpOpcode.WRITE: FtpHandlers._write,
    FtpOpcode.REMOVE: FtpHandlers._remove,
    FtpOpcode.MAKE_DIRECTORY: FtpHandlers._protected,
    FtpOpcode.REMOVE_DIRECTORY: FtpHandlers._protected,
    FtpOpcode.OPEN_TO_WRITE: FtpHandlers._open_to_write,
    FtpOpcode.TRUNCATE: FtpHandlers._truncate,
    FtpOpcode.RENAME: FtpHandlers._protected,
    FtpOpcode.CRC: FtpHandlers._crc,
}
"""All others are UNKNOWN_COMMAND, also 16, the listing with times: MAVSDK then falls back to LIST."""
