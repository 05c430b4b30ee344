"""ReceiveBuffer: what sockets receive, copied out of one place."""

from __future__ import annotations

import socket
from collections.abc import Hashable


class ReceiveBuffer:
    """Receives into the same bytes each time, for one thread.

    socket.recv() allocates a block of the heap as large as the most that may come, and shrinks it. What is kept of such
    blocks lies scattered and holds the memory between them: the heap grows by megabytes while its contents do not.
    """

    def __init__(self, size: int) -> None:
        """`size`: bytes that one call receives at most."""
        self._bytes = memoryview(bytearray(size))

    def recv(self, sock: socket.socket) -> bytes:
        """Return what socket.recv() would. Raises what that raises."""
        return bytes(self._bytes[: sock.recv_into(self._bytes)])

    def recvfrom(self, sock: socket.socket) -> tuple[bytes, Hashable]:
        """Return what socket.recvfrom() would. Raises what that raises."""
        size, address = sock.recvfrom_into(self._bytes)
        return bytes(self._bytes[:size]), address
