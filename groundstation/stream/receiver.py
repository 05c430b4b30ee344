"""The process that receives a camera's stream: it passes pictures on to screens, and records them.

Run as `python -m groundstation.stream.receiver --fd N --limit MB` by the station. Neither a flood of packets nor a slow
disk can delay the station, which never waits for it. It ends with the station.
"""

from __future__ import annotations

import argparse
import asyncio
import contextlib
import os
import signal
import socket
import time
from pathlib import Path

import msgspec

from groundstation.stream.copies import PacketCopies, is_copy
from groundstation.stream.orders import StreamOrders, StreamReport
from groundstation.stream.rtp import AccessUnit, Depacketizer, is_video
from groundstation.stream.sender_lock import SenderLock
from groundstation.stream.video_file import encode_unit
from groundstation.stream.video_folder import VideoFolder
from groundstation.stream.whole_pictures import WholePictures
from link.runtime.local_socket import take_over
from link.runtime.worker import Worker

NICE = 5
"""The station and the screen go first."""
ORDERS_MAX = 1 << 16
PACKET_MAX = 1 << 16
PACKETS_AT_ONCE = 64
"""Packets that are read before the orders are looked at again."""
BUFFER = 1 << 20
"""Bytes: a picture comes in a burst."""
REPORT_PERIOD = 1.0
RETRY = 2.0
"""s before a port that another program has is tried again."""
RECORD_AGAIN = 10.0
"""s before a disk that has failed is tried again."""
PENDING = 64
"""Units that may wait for the disk; further ones are left out."""
MEGABYTE = 1_000_000
LOOPBACK = "127.0.0.1"


class PictureRecording:
    """Writes units in a thread."""

    def __init__(self, limit: int) -> None:
        self.failure = ""
        """Why nothing is written."""
        self.written = ""
        """The newest file."""
        self._folder = VideoFolder(limit)
        self._worker = Worker("pictures", PENDING)
        self._blocked_until = 0.0

    def add(self, unit: AccessUnit, orders: StreamOrders, now: float) -> None:
        """Record a unit that came now."""
        if not orders.log or now < self._blocked_until:
            return
        at = int(now * 1e6) + orders.offset
        data = encode_unit(at, unit.data, key=unit.key, stamped=orders.stamped)
        self._worker.submit(lambda: self._write(Path(orders.log), data, key=unit.key))

    def pause(self) -> None:
        """Close the file: the stream has ended."""
        self._worker.submit(self._folder.close)

    def close(self) -> None:
        """Write the rest."""
        self.pause()
        self._worker.close(1.0)

    def _write(self, log: Path, data: bytes, *, key: bool) -> None:
        try:
            self._folder.write(log, data, key=key)
        except OSError as error:
            self.failure, self._blocked_until = error.strerror or str(error), time.monotonic() + RECORD_AGAIN
            with contextlib.suppress(OSError):
                self._folder.close()
        else:
            if self._folder.path is not None:
                self.failure, self.written = "", str(self._folder.path)


class StreamReceiver:
    """Obeys the newest orders."""

    def __init__(self, pipe: socket.socket, limit: int) -> None:
        self._pipe = pipe
        self._orders = StreamOrders()
        self._recording = PictureRecording(limit)
        self._copies = PacketCopies()
        self._units = Depacketizer()
        self._whole = WholePictures()
        self._lock = SenderLock()
        self._socket: socket.socket | None = None
        self._sender = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self._sender.setblocking(False)
        self._problem = ""
        self._retry_at = 0.0
        self._ended = asyncio.Event()

    async def run(self) -> None:
        """Run until the station ends."""
        loop = asyncio.get_running_loop()
        loop.add_reader(self._pipe, self._read_orders)
        loop.add_signal_handler(signal.SIGTERM, self._ended.set)
        while not self._ended.is_set():
            if self._orders.port and self._socket is None and time.monotonic() >= self._retry_at:
                self._open()
            self._report()
            with contextlib.suppress(TimeoutError):
                await asyncio.wait_for(self._ended.wait(), REPORT_PERIOD)
        self._close()
        self._recording.close()

    def _report(self) -> None:
        problem = self._problem or self._lock.complaint(time.monotonic())
        report = StreamReport(problem, self._recording.written, self._recording.failure)
        with contextlib.suppress(OSError):
            self._pipe.send(msgspec.json.encode(report))

    def _read_orders(self) -> None:
        while True:
            try:
                data = self._pipe.recv(ORDERS_MAX)
            except BlockingIOError:
                return
            except OSError:
                data = b""
            if not data:
                asyncio.get_running_loop().remove_reader(self._pipe)
                self._ended.set()
                return
            self._obey(msgspec.json.decode(data, type=StreamOrders))

    def _obey(self, orders: StreamOrders) -> None:
        before, self._orders = self._orders, orders
        self._lock.allowed = orders.senders
        if orders.port != before.port:
            self._close()
            self._problem = ""
            if orders.port:
                self._open()
                self._report()

    def _open(self) -> None:
        try:
            self._socket = _bind(self._orders.port)
        except OSError as error:
            self._problem = f"UDP port {self._orders.port}: {error.strerror}; which program has it: `ss -ulp`"
            self._retry_at = time.monotonic() + RETRY
            return
        self._problem, self._units, self._lock = "", Depacketizer(), SenderLock(self._orders.senders)
        asyncio.get_running_loop().add_reader(self._socket, self._receive)

    def _close(self) -> None:
        if self._socket is not None:
            asyncio.get_running_loop().remove_reader(self._socket)
            self._socket.close()
            self._socket = None
            self._recording.pause()

    def _receive(self) -> None:
        now = time.monotonic()
        for _ in range(PACKETS_AT_ONCE):
            if self._socket is None:
                return
            try:
                packet, (host, *_) = self._socket.recvfrom(PACKET_MAX)
            except OSError:
                return
            if not (is_video(packet) or is_copy(packet)) or not self._lock.passes(host, now):
                continue
            first = self._copies.take(packet)
            if first is not None:
                self._pass_on(first, now)

    def _pass_on(self, packet: bytes, now: float) -> None:
        """Send to the screens, and record, what is whole with this packet; of streams of others, what comes.

        A stream of others may have no key pictures (intra refresh), so that nothing would come after a lost packet.
        """
        screens, stamped = self._orders.screens, self._orders.stamped
        for port in () if stamped else screens:
            self._send(packet, port)
        for unit in self._units.take(packet, now):
            for port, numbered in self._whole.choose(unit, screens) if stamped else ():
                self._send(numbered, port)
            self._recording.add(unit, self._orders, now)

    def _send(self, packet: bytes, port: int) -> None:
        with contextlib.suppress(OSError):  # its decoder starts, or has no room
            self._sender.sendto(packet, (LOOPBACK, port))


def _bind(port: int) -> socket.socket:
    """Return a socket that gets what is sent to a port of this machine, over IPv4 and IPv6. Raises OSError."""
    if socket.has_dualstack_ipv6():
        opened = socket.socket(socket.AF_INET6, socket.SOCK_DGRAM)
        opened.setsockopt(socket.IPPROTO_IPV6, socket.IPV6_V6ONLY, 0)
    else:
        opened = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    try:
        opened.setblocking(False)
        opened.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, BUFFER)
        opened.bind(("", port))
    except OSError:
        opened.close()
        raise
    return opened


def main() -> None:
    """Run the process."""
    parser = argparse.ArgumentParser("groundstation.stream.receiver", description="Started by the station.")
    parser.add_argument("--fd", type=int, required=True)
    parser.add_argument("--limit", type=int, required=True, metavar="MB")
    options = parser.parse_args()
    os.nice(NICE)
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # of a terminal: the station ends us
    pipe = take_over(options.fd)
    pipe.setblocking(False)
    asyncio.run(_run(pipe, options.limit * MEGABYTE))


async def _run(pipe: socket.socket, limit: int) -> None:
    await StreamReceiver(pipe, limit).run()


if __name__ == "__main__":
    main()
