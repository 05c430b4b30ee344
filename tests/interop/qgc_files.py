"""How QGroundControl downloads a file (FTPManager): one burst after the other, then the holes piece by piece.

After a timeout it repeats its request from where it is, with the same sequence number, and accepts only answers with
the number that it expects.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from dialects import messages as m
from link.services.ftp.protocol import MAX_DATA, SEQUENCE_MASK, FtpError, FtpOpcode, FtpPacket, parse_packet

if TYPE_CHECKING:
    from tests.interop.qgroundcontrol import QGroundControl

LIMIT, TRIES = 1.0, 3
"""s for each answer, and the number of retries."""


class DownloadError(Exception):
    """QGroundControl gave up and continues without the file."""


class Download:
    """The download of one file."""

    def __init__(self, ground: QGroundControl, path: str, limit: float = LIMIT) -> None:
        self._ground = ground
        self._limit = limit
        self._path = path
        self._expected = 0
        """The sequence number of the next answer."""
        self._holes: list[tuple[int, int]] = []
        self._content = bytearray()

    def run(self) -> bytes:
        """Return the content. Raises DownloadError."""
        opened = self._ask(FtpPacket(0, FtpOpcode.OPEN, data=self._path.encode()), tries=0)
        if opened.op != FtpOpcode.ACK:
            raise DownloadError(f"{self._path}: {opened.data!r}")
        size = int.from_bytes(opened.data[:4], "little")
        self._burst(opened.session)
        while self._holes:
            self._fill(opened.session)
        if len(self._content) != size:
            raise DownloadError(f"{self._path}: {len(self._content)} bytes of {size}")
        self._ask(FtpPacket(0, FtpOpcode.RESET))
        return bytes(self._content)

    def _burst(self, session: int) -> None:
        """Read bursts to the end of the file, which is reported by a NAK."""
        ask = True
        while True:
            request = FtpPacket(0, FtpOpcode.BURST, session, offset=len(self._content), size=MAX_DATA)
            piece = self._ask(request) if ask else self._next(request)
            if piece.op == FtpOpcode.NAK:
                assert piece.data == bytes([FtpError.END_OF_FILE])
                return
            self._take(piece)
            ask = piece.burst_complete
            self._expected = piece.sequence if ask else piece.sequence + 1

    def _take(self, piece: FtpPacket) -> None:
        hole = piece.offset - len(self._content)
        if hole < 0:
            return
        if hole:
            self._holes.append((len(self._content), hole))
        self._content += bytes(hole) + piece.data

    def _fill(self, session: int) -> None:
        offset, missing = self._holes[0]
        piece = self._ask(FtpPacket(0, FtpOpcode.READ, session, offset=offset, size=min(MAX_DATA, missing)))
        assert (piece.op, piece.offset) == (FtpOpcode.ACK, offset)
        self._content[offset : offset + len(piece.data)] = piece.data
        offset, missing = offset + len(piece.data), missing - len(piece.data)
        self._holes[:1] = [(offset, missing)] if missing else []

    def _next(self, request: FtpPacket) -> FtpPacket:
        """Return the next answer of a burst; repeat the request if there is none."""
        return self._heard(request) or self._ask(request, again=True)

    def _ask(self, request: FtpPacket, *, tries: int = TRIES, again: bool = False) -> FtpPacket:
        for attempt in range(tries + 1):
            if attempt or again:
                self._ground.repeats += 1
                self._expected -= 2
            sequence = (self._expected + 1) & SEQUENCE_MASK
            self._expected = sequence + 1
            packet = FtpPacket(sequence, request.op, request.session, request.data, request.offset, size=request.size)
            self._ground.send(packet.message(1, 1))
            answer = self._heard(request)
            if answer is not None:
                return answer
        raise DownloadError(f"{self._path}: no answer to {FtpOpcode(request.op).name}")

    def _heard(self, request: FtpPacket) -> FtpPacket | None:
        answer = self._ground.wait(
            m.FileTransferProtocol, self._limit, lambda each: self._fits(request, parse_packet(each))
        )
        return None if answer is None else parse_packet(answer)

    def _fits(self, request: FtpPacket, answer: FtpPacket) -> bool:
        if answer.req_opcode != request.op:
            return False
        late = request.op == FtpOpcode.BURST and answer.op == FtpOpcode.ACK and answer.sequence >= self._expected
        return late or answer.sequence == self._expected
