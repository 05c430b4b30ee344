"""Packets of a connection between programs of one user. Nothing blocks."""

from __future__ import annotations

import socket

from link.transport.receive_buffer import ReceiveBuffer


def read_packet(sock: socket.socket, buffer: ReceiveBuffer) -> bytes | None:
    """Return the next packet, which must fit into `buffer`; None if there is none yet, b"" after the end."""
    try:
        return buffer.recv(sock)
    except BlockingIOError:
        return None
    except OSError:
        return b""
