"""Packets of a connection between programs of one user. Nothing blocks."""

from __future__ import annotations

import socket
from collections import deque

from link.transport.receive_buffer import ReceiveBuffer


def read_packet(sock: socket.socket, buffer: ReceiveBuffer) -> bytes | None:
    """Return the next packet, which must fit into `buffer`; None if there is none yet, b"" after the end."""
    try:
        return buffer.recv(sock)
    except BlockingIOError:
        return None
    except OSError:
        return b""


class UnsentPackets:
    """Packets for which a socket that does not block has no room yet."""

    def __init__(self, sock: socket.socket) -> None:
        self._sock = sock
        self._waiting: deque[bytes] = deque()

    @property
    def size(self) -> int:
        """Bytes that wait."""
        return sum(map(len, self._waiting))

    def add(self, packet: bytes) -> None:
        """Add a packet behind the others."""
        self._waiting.append(packet)

    def write(self) -> bool:
        """Send what there is room for; return whether nothing is left. Raises OSError."""
        try:
            while self._waiting:
                self._sock.send(self._waiting[0])
                self._waiting.popleft()
        except BlockingIOError:
            return False
        return True
