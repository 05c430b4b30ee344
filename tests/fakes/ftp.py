"""A file service as ArduPilot's: one session, bursts that end by a NAK, sizes of made files only estimated."""

from __future__ import annotations

import struct
from collections.abc import Callable, Iterator

HEADER = struct.Struct("<HBBBBBxI")
ACK, NAK = 128, 129
NOT_FOUND, END_OF_FILE, UNKNOWN, PROTECTED = 10, 6, 7, 9
BURST_PIECES = 20


class ForeignFtp:
    """Answers requests; `files` are its files by path, `made` makes param.pck."""

    def __init__(self, made: Callable[[], bytes | None]) -> None:
        self.files: dict[str, bytes] = {}
        self._made = made
        self._open: bytes = b""
        self._writing: tuple[str, bytearray] | None = None
        self._last: tuple[tuple[int, int], bytes] | None = None

    def answer(self, payload: bytes) -> Iterator[bytes]:
        """Yield the payloads of the replies."""
        sequence, session, op, size, _, _, offset = HEADER.unpack_from(payload)
        data = payload[12 : 12 + size]

        def reply(code: int, content: bytes, at: int = offset, after: int = 1, complete: bool = False) -> bytes:
            head = HEADER.pack((sequence + after) & 0xFFFF, session, code, len(content), op, complete, at)
            return (head + content).ljust(251, b"\0")

        if op == 15:
            yield from self._burst(offset, size, reply)
            return
        # A request that is repeated is answered by the same reply, and its numbers alone say that it is one.
        if self._last is None or self._last[0] != (session, sequence):
            result = self._handle(op, data.split(b"\0")[0].decode(errors="replace"), data, offset, size)
            answer = reply(NAK, bytes([result])) if isinstance(result, int) else reply(ACK, result)
            self._last = (session, sequence), answer
        yield self._last[1]

    def _burst(self, offset: int, size: int, reply: Callable[..., bytes]) -> Iterator[bytes]:
        for number in range(BURST_PIECES):
            at = offset + number * size
            piece = self._open[at : at + size]
            if not piece:
                yield reply(NAK, bytes([END_OF_FILE]), at, number + 1)
                return
            yield reply(ACK, piece, at, number + 1, number == BURST_PIECES - 1)

    def _handle(self, op: int, path: str, data: bytes, offset: int, size: int) -> bytes | int:
        """Return the data of an ACK, or the error of a NAK."""
        handlers: dict[int, Callable[[], bytes | int]] = {
            1: self._close,
            2: self._close,
            3: lambda: self._list(path, offset),
            4: lambda: self._open_file(path),
            5: lambda: self._open[offset : offset + size] or END_OF_FILE,
            6: lambda: self._create(path),
            7: lambda: self._write(data, offset),
            8: lambda: NOT_FOUND if self.files.pop(path, None) is None else b"",
            14: lambda: self._checksum(path),
        }
        return handlers.get(op, lambda: UNKNOWN)()

    def _create(self, path: str) -> bytes | int:
        if path.startswith("@"):
            return PROTECTED
        self._writing = (path, bytearray())
        return b""

    def _write(self, data: bytes, offset: int) -> bytes | int:
        if self._writing is None:
            return UNKNOWN
        content = self._writing[1]
        content.extend(bytes(max(0, offset + len(data) - len(content))))
        content[offset : offset + len(data)] = data
        return b""

    def _close(self) -> bytes:
        if self._writing is not None:
            self.files[self._writing[0]] = bytes(self._writing[1])
        self._writing, self._open = None, b""
        return b""

    def _list(self, folder: str, skip: int) -> bytes | int:
        inside = sorted(path for path in self.files if path.rpartition("/")[0] == folder.rstrip("/"))
        packed = b""
        for path in inside[skip:]:
            line = f"F{path.rpartition('/')[2]}\t{len(self.files[path])}".encode() + b"\0"
            if len(packed) + len(line) > 239:
                break
            packed += line
        return packed or END_OF_FILE

    def _open_file(self, path: str) -> bytes | int:
        made = self._made() if path.startswith("@PARAM/param.pck") else self.files.get(path)
        if made is None:
            return NOT_FOUND
        self._open = made
        announced = len(made) + 1400 if path.startswith("@") else len(made)
        return announced.to_bytes(4, "little")

    def _checksum(self, path: str) -> bytes | int:
        data = self.files.get(path)
        if data is None:
            return NOT_FOUND
        crc = 0
        for byte in data:
            crc ^= byte
            for _ in range(8):
                crc = (crc >> 1) ^ (0xEDB88320 if crc & 1 else 0)
        return crc.to_bytes(4, "little")
