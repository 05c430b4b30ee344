"""Connects to a running station of this user."""

from __future__ import annotations

import contextlib
import errno
import os
import socket
import struct
from pathlib import Path

from groundstation.station_socket.folder import list_sockets, socket_address
from groundstation.station_socket.hello import HELLO_WITHIN, Hello, encode
from link.runtime.local_socket import REFUSES_WHEN_FULL, open_socket, peer_credentials

SOCKET_BUFFER = 1 << 20
"""Bytes requested each way, so that a snapshot (< 60 kB) or a second of keys fits; the kernel may grant less."""

_TIMEVAL = struct.Struct("2l")


class NoStationError(Exception):
    """No station takes this program; the message is one line for the user."""


def running_stations() -> list[int]:
    """Return the process ids of the stations that run; sockets that a killed one has left are removed.

    One that hangs and takes no more connections counts, too. Nothing is waited for. Raises FolderError.
    """
    found = []
    for pid, path in list_sockets():
        try:
            sock = _open(path, pid, 0.0)
        except TimeoutError:
            found.append(pid)
            continue
        if sock is not None:
            sock.close()
            found.append(pid)
    return found


def connect(pid: int, hello: Hello, within: float = HELLO_WITHIN) -> socket.socket:
    """Connect to the station with this process id and introduce the program. Raises NoStationError, FolderError.

    The socket gives up after `within` s, here and when it is read.
    """
    paths = dict(list_sockets())
    try:
        sock = _open(paths[pid], pid, within) if pid in paths else None
    except TimeoutError:
        raise NoStationError(f"station {pid} takes no more programs: it may hang") from None
    if sock is None:
        raise NoStationError(f"no station with process id {pid} runs here")
    try:
        ours = peer_credentials(sock)[1] == os.getuid()
    except OSError:
        sock.close()
        raise NoStationError(f"station {pid} has just ended") from None
    if not ours:
        sock.close()
        raise NoStationError(f"the socket of station {pid} belongs to another user")
    sock.send(encode(hello))
    return sock


def _open(path: Path, pid: int, within: float) -> socket.socket | None:
    """Return a connection; None where nobody listens any more, and then the socket is removed.

    Raises TimeoutError if the queue of those who connect stays full.
    """
    sock = open_socket()
    sock.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, SOCKET_BUFFER)
    # Only the kernel waits for room in the queue: with a timeout of Python, connect() returns EAGAIN at once
    wait = divmod(round(within * 1_000_000), 1_000_000)
    sock.setsockopt(socket.SOL_SOCKET, socket.SO_SNDTIMEO, _TIMEVAL.pack(*wait))
    sock.setblocking(bool(within))
    try:
        with socket_address(path) as address:
            sock.connect(address)
    except BlockingIOError:
        sock.close()
        raise TimeoutError from None
    except OSError as error:
        sock.close()
        if error.errno == errno.ECONNREFUSED:
            if REFUSES_WHEN_FULL and _runs(pid):
                raise TimeoutError from None
            with contextlib.suppress(OSError):
                path.unlink()
        return None
    sock.settimeout(within)
    return sock


def _runs(pid: int) -> bool:
    """Return whether this user has a process with this id."""
    try:
        os.kill(pid, 0)
    except OSError:
        return False
    return True
