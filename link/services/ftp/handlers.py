"""Handlers of the FTP opcodes: effects on files and sessions, and replies, which server.py sends."""

from __future__ import annotations

from collections.abc import Callable

import msgspec

from link.services.ftp.files import BytesContent, Content, DirectoryEntry, FileTree, Location, NotReadyError
from link.services.ftp.protocol import MAX_DATA, FtpError, FtpOpcode, FtpPacket, crc32
from link.services.ftp.sessions import FtpClientId, FtpSession, FtpSessions

CRC_PIECE = 64 * 1024
"""Bytes added to a checksum in one tick: 0.1 ms on a Raspberry Pi."""

FtpReply = bytes | FtpError | None
"""Data of an ACK, the error of a NAK, or None: try again at the next tick."""


class FtpRequest(msgspec.Struct):
    """A request, with the state of a reply that takes more than one tick."""

    client: FtpClientId
    packet: FtpPacket
    allowed: bool | None
    """Whether this client may write; None: not known at the moment, and the client repeats its request."""
    content: Content | None = None
    crc: int = 0
    offset: int = 0


class FtpHandlers:
    """Handles all opcodes but BURST."""

    def __init__(self, tree: FileTree, sessions: FtpSessions) -> None:
        self._tree = tree
        self._sessions = sessions

    def handle(self, request: FtpRequest, now: float) -> FtpReply:
        """Handle one request."""
        if (request.packet.size or 0) > MAX_DATA:
            return FtpError.INVALID_SIZE
        handler = _HANDLERS.get(request.packet.op)
        try:
            return handler(self, request, now) if handler else FtpError.UNKNOWN_COMMAND
        except NotReadyError:
            return None

    # ---- sessions ----

    def _none(self, request: FtpRequest, now: float) -> FtpReply:
        return b""

    def _terminate(self, request: FtpRequest, now: float) -> FtpReply:
        """Close a session.

        An unknown one is not an error: MAVSDK closes after a listing, and a reply may have been lost.
        """
        session = self._sessions.get(request.client, request.packet.session, now)
        return b"" if session is None else self._close(session)

    def _reset(self, request: FtpRequest, now: float) -> FtpReply:
        """Close all sessions of this client, and none of others."""
        faults = [self._close(session) for session in self._sessions.for_client(request.client)]
        return next((fault for fault in faults if fault), b"")

    def _close(self, session: FtpSession) -> bytes | FtpError:
        """Close a session and store a written file; QGroundControl closes it by RESET."""
        fault = None
        if session.writes is not None and session.data is not None:
            fault = session.writes.folder.store(session.writes.name, bytes(session.data))
        self._sessions.close(session)
        return fault or b""

    # ---- reading ----

    def _list(self, request: FtpRequest, now: float) -> FtpReply:
        place = self._tree.find(request.packet.data)
        if place is None or place.name:
            return FtpError.NOT_FOUND
        packed = b""
        for entry in self._tree.listing(place.folder)[request.packet.offset :]:
            line = _line(entry)
            if len(packed) + len(line) > MAX_DATA:
                break
            packed += line
        return packed or FtpError.END_OF_FILE

    def _open(self, request: FtpRequest, now: float) -> FtpReply:
        content = self._find(request)
        if content is None:
            return FtpError.NOT_FOUND
        session = FtpSession(request.client, request.packet.session, now, content)
        return self._sessions.add(session, now) or content.size.to_bytes(4, "little")

    def _read(self, request: FtpRequest, now: float) -> FtpReply:
        packet = request.packet
        session = self._sessions.get(request.client, packet.session, now)
        if session is None or session.data is not None:
            return FtpError.INVALID_SESSION
        if packet.offset >= session.content.size:
            return FtpError.END_OF_FILE
        data = session.content.read(packet.offset, packet.size or MAX_DATA)
        return FtpError.FAIL if data == b"" else data  # empty: the file was removed

    def _crc(self, request: FtpRequest, now: float) -> FtpReply:
        content = request.content = request.content or self._find(request)
        if content is None:
            return FtpError.NOT_FOUND
        piece = content.read(request.offset, CRC_PIECE)
        if piece == b"" and request.offset < content.size:
            return FtpError.FAIL  # the file was removed
        if piece is not None:
            request.crc, request.offset = crc32(piece, request.crc), request.offset + len(piece)
        return request.crc.to_bytes(4, "little") if request.offset >= content.size else None

    def _find(self, request: FtpRequest) -> Content | None:
        place = self._tree.find(request.packet.data)
        return place.folder.open(place.name, place.query) if place and place.name else None

    # ---- writing ----

    def _create(self, request: FtpRequest, now: float) -> FtpReply:
        place = self._writable(request)
        if isinstance(place, FtpError):
            return place
        return self._begin_writing(request, place, bytearray(), now)

    def _open_to_write(self, request: FtpRequest, now: float) -> FtpReply:
        found = self._existing(request)
        if isinstance(found, FtpError):
            return found
        place, content = found
        data = content.read(0, content.size)
        return None if data is None else self._begin_writing(request, place, bytearray(data), now)

    def _begin_writing(self, request: FtpRequest, place: Location, data: bytearray, now: float) -> FtpReply:
        session = FtpSession(request.client, request.packet.session, now, BytesContent(b""), place, data)
        return self._sessions.add(session, now) or b""

    def _write(self, request: FtpRequest, now: float) -> FtpReply:
        packet = request.packet
        session = self._sessions.get(request.client, packet.session, now)
        if session is None:
            return FtpError.INVALID_SESSION
        return session.write(packet.offset, packet.data) or b""

    def _truncate(self, request: FtpRequest, now: float) -> FtpReply:
        found = self._existing(request)
        if isinstance(found, FtpError):
            return found
        place, content = found
        data = content.read(0, min(request.packet.offset, content.size))
        return None if data is None else place.folder.store(place.name, data) or b""

    def _remove(self, request: FtpRequest, now: float) -> FtpReply:
        """Remove a file. A folder that cannot be written may still allow it, as that of the logs does."""
        place = self._tree.find(request.packet.data)
        if place is None or not place.name or place.query:
            return FtpError.NOT_FOUND
        return (place.folder.remove(place.name) if _may_write(request) else FtpError.PROTECTED) or b""

    def _protected(self, request: FtpRequest, now: float) -> FtpReply:
        """Reject a change of the folders."""
        return FtpError.PROTECTED

    def _writable(self, request: FtpRequest) -> Location | FtpError:
        place = self._tree.find(request.packet.data)
        if place is None or not place.name or place.query:
            return FtpError.NOT_FOUND
        return place if place.folder.writable(place.name) and _may_write(request) else FtpError.PROTECTED

    def _existing(self, request: FtpRequest) -> tuple[Location, Content] | FtpError:
        """Return the file that the client may write, and what it holds."""
        place = self._writable(request)
        if isinstance(place, FtpError):
            return place
        content = place.folder.open(place.name, {})
        return FtpError.NOT_FOUND if content is None else (place, content)


def _line(entry: DirectoryEntry) -> bytes:
    """Return a line of a listing: F, name, tab, size; or D, name."""
    text = f"D{entry.name}" if entry.size is None else f"F{entry.name}\t{entry.size}"
    return text.encode("ascii", "replace") + b"\0"


def _may_write(request: FtpRequest) -> bool:
    """Return whether the client may write. Raises NotReadyError if that is not known at the moment."""
    if request.allowed is None:
        raise NotReadyError
    return request.allowed


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
"""Other opcodes are UNKNOWN_COMMAND, also 16, the listing with times: MAVSDK then falls back to LIST."""
