"""Sockets between the programs of one computer: whole packets, the end of the other side, and who that is.

The kernel of Linux keeps packets apart (SOCK_SEQPACKET). macOS refuses that kind (EPROTONOSUPPORT), and its datagrams
report no end of file: a station would outlive its killed terminal. There a stream carries the packets, each behind its
length, and PacketStream looks like a SOCK_SEQPACKET socket to its users.
"""

from __future__ import annotations

import contextlib
import errno
import os
import socket
import sys
import time
from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from _typeshed import ReadableBuffer, WriteableBuffer

KEEPS_PACKETS = sys.platform != "darwin"
"""The kernel has SOCK_SEQPACKET for local sockets."""

LONGEST_ADDRESS = 107 if sys.platform == "linux" else 103
"""Bytes of a path in a socket address: sun_path of unix(7) and of unix(4), less the zero behind it."""

REFUSES_WHEN_FULL = sys.platform == "darwin"
"""A socket that listens, and whose queue is full, refuses (ECONNREFUSED) like one that nobody has open any more."""

BUFFER = 1 << 20
"""Bytes requested each way of a stream, whose default on macOS is 8 kB; the kernel may grant less."""
LARGEST = 1 << 20
"""Bytes of the largest packet of a stream; a longer one shows that the two ends do not agree."""

_LENGTH = 4
"""Bytes of the length before each packet of a stream, the highest first."""
_UCRED = 12
"""Bytes of `struct ucred` of Linux: process, user, group."""
SOL_LOCAL, LOCAL_PEERCRED, LOCAL_PEERPID = 0, 1, 2
"""Level and options of macOS's <sys/un.h>; Python does not name them all."""
_XUCRED = 76
"""Bytes of `struct xucred` of macOS's <sys/ucred.h>: version, user, number of groups, 16 groups."""


class PacketStream(socket.socket):
    """A stream that sends and receives whole packets, each behind its length: what is said of SOCK_SEQPACKET holds.

    A packet that does not block counts as sent once the kernel has taken its first bytes; the rest goes before the next
    one. Nothing of a packet is read before all of it has arrived, and nothing behind its end, so that the descriptor is
    readable as long as another one waits. Only what is overridden here is for use.
    """

    def __init__(self, fileno: int | None = None) -> None:
        """Open a socket, or take over a descriptor. Raises OSError."""
        super().__init__(socket.AF_UNIX, socket.SOCK_STREAM, 0, fileno)
        self._unsent = b""
        self._packet = bytearray(_LENGTH)
        self._have, self._wanted = 0, _LENGTH
        self._carried: list[tuple[int, int, bytes]] = []
        """Descriptors that have come with the packet so far."""
        for option in (socket.SO_SNDBUF, socket.SO_RCVBUF):
            with contextlib.suppress(OSError):  # more than this computer allows
                self.setsockopt(socket.SOL_SOCKET, option, BUFFER)

    def accept(self) -> tuple[PacketStream, Any]:
        """Accept a connection. Raises OSError."""
        sock, address = super().accept()
        return PacketStream(sock.detach()), address

    def send(self, data: ReadableBuffer, flags: int = 0, /) -> int:
        """Send a packet; return its size. Raises BlockingIOError if there is no room, OSError."""
        return self.sendmsg([data], (), flags)

    def sendmsg(
        self,
        buffers: Iterable[ReadableBuffer],
        ancdata: Iterable[tuple[int, int, ReadableBuffer]] = (),
        flags: int = 0,
        address: Any = None,
        /,
    ) -> int:
        """Send `buffers` as one packet, with descriptors. Raises as send()."""
        packet = b"".join(map(bytes, buffers))
        if len(packet) > LARGEST:
            raise OSError(errno.EMSGSIZE, os.strerror(errno.EMSGSIZE))
        self._send_rest()
        whole = len(packet).to_bytes(_LENGTH, "big") + packet
        self._unsent = whole[super().sendmsg([whole], ancdata, flags) :]
        if self.gettimeout() != 0.0:
            self._send_rest()
        return len(packet)

    def recv(self, bufsize: int, flags: int = 0, /) -> bytes:
        """Return the next packet, cut off behind `bufsize` bytes; b"" at the end of the stream. Raises OSError.

        Raises BlockingIOError if it has not arrived, TimeoutError if it does not arrive in time.
        """
        return self.recvmsg(bufsize, 0, flags)[0]

    def recv_into(self, buffer: WriteableBuffer, nbytes: int = 0, flags: int = 0) -> int:
        """Receive the next packet into `buffer`; return its size. Raises as recv()."""
        with memoryview(buffer).cast("B") as room:
            packet = self.recv(nbytes or len(room), flags)
            room[: len(packet)] = packet
        return len(packet)

    def recvmsg(
        self, bufsize: int, ancbufsize: int = 0, flags: int = 0, /
    ) -> tuple[bytes, list[tuple[int, int, bytes]], int, Any]:
        """Return the next packet and the descriptors that came with it, as socket.recvmsg(). Raises as recv()."""
        timeout = self.gettimeout()
        deadline = time.monotonic() + timeout if timeout else None
        try:
            while self._have < self._wanted:
                if deadline is not None:
                    self.settimeout(max(0.0, deadline - time.monotonic()) or 1e-6)
                if not self._receive_some(ancbufsize, flags):
                    self._begin_packet()  # cut off in the middle of a packet
                    return b"", [], 0, None
        finally:
            if deadline is not None:
                self.settimeout(timeout)
        packet, carried = bytes(self._packet[_LENGTH : self._wanted][:bufsize]), self._carried
        self._begin_packet()
        return packet, carried, 0, None

    def _begin_packet(self) -> None:
        self._have, self._wanted, self._carried = 0, _LENGTH, []

    def _receive_some(self, ancillary: int, flags: int) -> int:
        """Receive more of the packet; return how much. Raises OSError."""
        if len(self._packet) < self._wanted:
            self._packet.extend(bytes(self._wanted - len(self._packet)))
        with memoryview(self._packet)[self._have : self._wanted] as room:
            size, carried, _, _ = super().recvmsg_into([room], ancillary, flags)
        self._carried += carried
        self._have += size
        if self._have == self._wanted == _LENGTH:
            length = int.from_bytes(self._packet[:_LENGTH], "big")
            if length > LARGEST:
                raise OSError(errno.EBADMSG, os.strerror(errno.EBADMSG))
            self._wanted += length
        return size

    def _send_rest(self) -> None:
        while self._unsent:
            self._unsent = self._unsent[super().send(self._unsent) :]


def open_socket() -> socket.socket:
    """Return a socket to listen or to connect with. Raises OSError."""
    return socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET) if KEEPS_PACKETS else PacketStream()


def open_pair() -> tuple[socket.socket, socket.socket]:
    """Return two connected sockets. Raises OSError."""
    if KEEPS_PACKETS:
        return socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
    ours, theirs = socket.socketpair(socket.AF_UNIX, socket.SOCK_STREAM)
    return PacketStream(ours.detach()), PacketStream(theirs.detach())


def take_over(descriptor: int) -> socket.socket:
    """Return the socket of a descriptor that another process has passed on. Raises OSError."""
    sock = socket.socket(fileno=descriptor)
    return PacketStream(sock.detach()) if sock.type == socket.SOCK_STREAM else sock


def peer_credentials(sock: socket.socket) -> tuple[int, int]:
    """Return the process id and the user id of the other end, as the kernel knows them. Raises OSError."""
    if hasattr(socket, "SO_PEERCRED"):
        pid, user, _ = _read_integers(sock.getsockopt(socket.SOL_SOCKET, socket.SO_PEERCRED, _UCRED))
        return pid, user
    version, user, *_ = _read_integers(sock.getsockopt(SOL_LOCAL, LOCAL_PEERCRED, _XUCRED))
    if version != 0:  # XUCRED_VERSION
        raise OSError(errno.EPROTO, "the kernel describes the other end in an unknown way")
    return sock.getsockopt(SOL_LOCAL, LOCAL_PEERPID), user


def _read_integers(raw: bytes) -> list[int]:
    """Return the 32-bit numbers of a structure of the kernel. Without struct, which takes 0.5 ms of each start."""
    return [int.from_bytes(raw[at : at + 4], sys.byteorder) for at in range(0, len(raw), 4)]
