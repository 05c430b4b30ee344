"""ProgramListener: the station's socket in the runtime folder, and the first packets of those who connect."""

from __future__ import annotations

import asyncio
import contextlib
import logging
import os
import socket
from collections.abc import Callable
from pathlib import Path

import msgspec

from groundstation.station_socket.connect import SOCKET_BUFFER
from groundstation.station_socket.folder import FolderError, make_folder, socket_address, socket_path
from groundstation.station_socket.hello import HELLO_WITHIN, MAX_HELLO, Hello, StationFailed, decode_hello, encode
from link.runtime.local_socket import open_socket, peer_credentials

log = logging.getLogger(__name__)

MAX_WAITING = 16
"""Programs that have connected and not said what they are; further ones are refused."""


class Caller(msgspec.Struct, frozen=True):
    """A program of this user that has connected."""

    sock: socket.socket
    hello: Hello
    pid: int


class ProgramListener:
    """Accepts programs of this user. `take` gets each that has said what it is, and returns why not to take it."""

    def __init__(self, take: Callable[[Caller], str | None]) -> None:
        self._take = take
        self._socket: socket.socket | None = None
        self._path: Path | None = None
        self._waiting: dict[socket.socket, asyncio.TimerHandle] = {}

    def start(self) -> str | None:
        """Listen; the loop runs. Return why that is not possible."""
        sock = open_socket()
        sock.setblocking(False)
        try:
            path = socket_path(make_folder(), os.getpid())
            _listen(sock, path)
        except (FolderError, OSError) as error:
            sock.close()
            return str(error)
        self._socket, self._path = sock, path
        asyncio.get_running_loop().add_reader(sock, self._accept)
        return None

    def close(self) -> None:
        """Listen no more."""
        if self._socket is None or self._path is None:
            return
        asyncio.get_running_loop().remove_reader(self._socket)
        self._socket.close()
        with contextlib.suppress(OSError):
            self._path.unlink()
        for sock in list(self._waiting):
            self._forget(sock)
            sock.close()

    def _accept(self) -> None:
        assert self._socket is not None
        try:
            sock, _ = self._socket.accept()
        except OSError:
            return
        sock.setblocking(False)
        try:
            sock.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, SOCKET_BUFFER)
            pid, user = peer_credentials(sock)
        except OSError:  # macOS, of one that has ended already
            sock.close()
            return
        if user != os.getuid():
            log.warning("process %d of user %d was refused", pid, user)
            _refuse(sock, f"this station belongs to another user (uid {os.getuid()})")
        elif len(self._waiting) >= MAX_WAITING:
            _refuse(sock, "too many programs connect to this station")
        else:
            loop = asyncio.get_running_loop()
            self._waiting[sock] = loop.call_later(HELLO_WITHIN, self._give_up, sock)
            loop.add_reader(sock, self._read, sock, pid)

    def _read(self, sock: socket.socket, pid: int) -> None:
        self._forget(sock)
        try:
            hello = decode_hello(sock.recv(MAX_HELLO))
        except (OSError, msgspec.DecodeError):
            sock.close()
            return
        if refusal := self._take(Caller(sock, hello, pid)):
            _refuse(sock, refusal)

    def _give_up(self, sock: socket.socket) -> None:
        self._forget(sock)
        sock.close()

    def _forget(self, sock: socket.socket) -> None:
        self._waiting.pop(sock).cancel()
        asyncio.get_running_loop().remove_reader(sock)


def _listen(sock: socket.socket, path: Path) -> None:
    """Listen at a path that appears once somebody listens there: others remove a socket that refuses them."""
    new = path.with_name(f"new-{path.name}")
    new.unlink(missing_ok=True)  # of a process that had our id before
    before = os.umask(0o177)
    try:
        with socket_address(new) as address:
            sock.bind(address)
    finally:
        os.umask(before)
    sock.listen(MAX_WAITING)
    new.replace(path)


def _refuse(sock: socket.socket, line: str) -> None:
    with contextlib.suppress(OSError):
        sock.send(encode(StationFailed(line)))
    sock.close()
