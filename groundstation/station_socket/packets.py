"""Packets of a connection between programs of one user. Nothing blocks."""

from __future__ import annotations

import socket


def read_packet(sock: socket.socket, largest: int) -> bytes | None:
    """Return the next packet of at most `largest` bytes; None if there is none yet, b"" after the end."""
    try:
        return sock.recv(largest)
    except BlockingIOError:
        return None
    except OSError:
        return b""
