"""The reference of `services` on a network: both ends of the protocols in the barest form that works without loss.

Blocking loops answer each datagram before they read the next: no pacing but the receive buffer of a socket, no repeats,
no checks, no telemetry.

Usage of the vehicle's end: python -m tests.benchmarks.bare_services PORT PARAMETERS FILE
"""

from __future__ import annotations

import socket
import sys
import time
from collections.abc import Hashable, Iterator, Sequence
from pathlib import Path
from typing import TypeVar

from dialects import codec
from dialects import messages as m
from dialects.enums import MissionResult, MissionType
from link.protocol.framer import Framer
from link.services.ftp.protocol import MAX_DATA, FtpOpcode, FtpPacket, parse_packet
from tests.benchmarks.figures import BenchmarkError
from tests.benchmarks.traffic import framed

VEHICLE = (1, 1)
GROUND = (255, 190)
BURST = 200
"""Messages of a burst, as in our own server."""
AT_ONCE, PAUSE = 64, 0.0005
"""Datagrams and s: more at once do not fit into the receive buffer of a socket (212 kB)."""
WITHIN = 10.0
"""s without an answer after which the reference has failed."""

M = TypeVar("M", bound=m.Message)


class Line:
    """A socket that sends and receives messages, one per datagram."""

    def __init__(self, sock: socket.socket, ids: tuple[int, int]) -> None:
        self._socket = sock
        self._ids = ids
        self._framer = Framer(stream=False)
        self._sequence = 0
        sock.settimeout(WITHIN)

    def say(self, message: m.Message, address: Hashable = None) -> None:
        """Send to `address`, or to where the socket is connected."""
        self._sequence = (self._sequence + 1) & 0xFF
        data = framed(message, self._sequence, *self._ids)
        if address is None:
            self._socket.send(data)
        else:
            self._socket.sendto(data, address)  # type: ignore[call-overload]

    def hear(self) -> tuple[list[m.Message], Hashable]:
        """Return the messages of the next datagram, and its source."""
        data, address = self._socket.recvfrom(2048)
        return [codec.decode_frame(number, raw) for number, *_, raw in self._framer.feed(data, 0.0)], address

    def await_(self, kind: type[M]) -> M:
        """Return the next message of a kind. Raises BenchmarkError."""
        try:
            while True:
                for message in self.hear()[0]:
                    if isinstance(message, kind):
                        return message
        except TimeoutError:
            raise BenchmarkError(f"the bare server said no {kind.msgname} for {WITHIN:g} s") from None


# ---- the vehicle's end ----


class Server:
    """Parameters by index, one mission, one file."""

    def __init__(self, parameters: int, file: bytes) -> None:
        self._parameters = parameters
        self._file = file
        self._items: list[m.MissionItemInt] = []
        self._count = 0

    def answers(self, message: m.Message) -> Iterator[m.Message]:
        """Answer one message of the client."""
        match message:
            case m.ParamRequestList():
                for index in range(self._parameters):
                    yield m.ParamValue(b"PARAMETER_%d" % index, 0.1 * index, 9, self._parameters, index)
            case m.FileTransferProtocol():
                yield from (packet.message(*GROUND) for packet in self._packets(parse_packet(message)))
            case _:
                yield from self._mission(message)

    def _mission(self, message: m.Message) -> Iterator[m.Message]:
        match message:
            case m.MissionCount():
                self._items, self._count = [], message.count
                yield m.MissionRequestInt(*GROUND, 0, MissionType.MISSION)
            case m.MissionItemInt():
                self._items.append(message)
                if len(self._items) < self._count:
                    yield m.MissionRequestInt(*GROUND, len(self._items), MissionType.MISSION)
                else:
                    yield m.MissionAck(*GROUND, MissionResult.ACCEPTED, MissionType.MISSION)
            case m.MissionRequestList():
                yield m.MissionCount(*GROUND, len(self._items), MissionType.MISSION)
            case m.MissionRequestInt():
                yield self._items[message.seq]

    def _packets(self, asked: FtpPacket) -> Iterator[FtpPacket]:
        if asked.op != FtpOpcode.BURST:
            size = len(self._file).to_bytes(4, "little")
            yield FtpPacket(asked.sequence + 1, FtpOpcode.ACK, asked.session, size, 0, asked.op)
            return
        for number in range(BURST):
            offset = asked.offset + number * MAX_DATA
            data = self._file[offset : offset + MAX_DATA]
            last = number == BURST - 1 or offset + MAX_DATA >= len(self._file)
            yield FtpPacket(
                asked.sequence + 1 + number, FtpOpcode.ACK, asked.session, data, offset, FtpOpcode.BURST, last
            )
            if last:
                return


def serve(port: int, server: Server) -> None:
    """Serve until killed."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sock:
        sock.bind(("127.0.0.1", port))
        line = Line(sock, VEHICLE)
        sock.settimeout(None)
        print("bare services ready", flush=True)
        while True:
            heard, address = line.hear()
            for message in heard:
                for number, answer in enumerate(server.answers(message), 1):
                    line.say(answer, address)
                    if number % AT_ONCE == 0:
                        time.sleep(PAUSE)


# ---- the ground station's end ----


def fetch_params(line: Line) -> None:
    """Read until all have arrived."""
    line.say(m.ParamRequestList(*VEHICLE))
    first = line.await_(m.ParamValue)
    for _ in range(first.param_count - 1):
        line.await_(m.ParamValue)


def upload(line: Line, items: Sequence[m.MissionItemInt]) -> None:
    """Upload item by item, as requested."""
    line.say(m.MissionCount(*VEHICLE, len(items), MissionType.MISSION))
    for _ in items:
        line.say(items[line.await_(m.MissionRequestInt).seq])
    line.await_(m.MissionAck)


def download(line: Line) -> None:
    """Download the mission, item by item."""
    line.say(m.MissionRequestList(*VEHICLE, MissionType.MISSION))
    for number in range(line.await_(m.MissionCount).count):
        line.say(m.MissionRequestInt(*VEHICLE, number, MissionType.MISSION))
        line.await_(m.MissionItemInt)
    line.say(m.MissionAck(*VEHICLE, MissionResult.ACCEPTED, MissionType.MISSION))


def fetch_file(line: Line) -> int:
    """Download by bursts; return the bytes that arrived. Losses are not requested again."""
    line.say(FtpPacket(1, FtpOpcode.OPEN, 0, b"file").message(*VEHICLE))
    size = int.from_bytes(parse_packet(line.await_(m.FileTransferProtocol)).data, "little")
    offset = got = 0
    while offset < size:
        line.say(FtpPacket(3, FtpOpcode.BURST, 0, b"", offset, size=MAX_DATA).message(*VEHICLE))
        complete = False
        while not complete:
            packet = parse_packet(line.await_(m.FileTransferProtocol))
            got += len(packet.data)
            offset, complete = packet.offset + len(packet.data), packet.burst_complete
    return got


def main(port: str, parameters: str, file: str) -> None:
    """Run the vehicle's end."""
    serve(int(port), Server(int(parameters), Path(file).read_bytes()))


if __name__ == "__main__":
    main(*sys.argv[1:4])
