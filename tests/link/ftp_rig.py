"""A vehicle with files, for the tests of MAVLink FTP."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from link.core import Peer
from link.services.ftp.files import Content, DirectoryEntry, FileTree, Folder, GeneratedFolder, MemoryFolder, Query
from link.services.ftp.protocol import FtpError, FtpOpcode, FtpPacket, parse_packet
from link.services.ftp.server import FtpServer
from link.services.pacing import BulkPacer
from tests.link.services_world import from_gcs, messages

GENERAL = b'{"version": 1}'
LOG = bytes(range(256)) * 40
SECRET = b"root:x:0:0"
MAX_OFFSET = 0xFFFF_FFFF
"""Largest offset that a packet can hold."""


@dataclass
class SlowContent:
    """A file on a disk that takes a tick for each read."""

    data: bytes
    waited: bool = True

    @property
    def size(self) -> int:
        return len(self.data)

    def read(self, offset: int, size: int) -> bytes | None:
        self.waited = not self.waited
        return self.data[offset : offset + size] if self.waited else None


class SlowFolder(MemoryFolder):
    def open(self, name: str, query: Query) -> Content | None:
        return SlowContent(self.files[name]) if name in self.files else None


def only_plans(name: str, data: bytes) -> FtpError | None:
    if not name.endswith(".plan"):
        return FtpError.PROTECTED
    return None if data.startswith(b"{") else FtpError.FAIL


@dataclass
class FtpRig:
    """A server, what was written to it, and short words to ask it."""

    rate: float = 1e6
    allowed: bool = True
    logs: dict[str, bytes] = field(default_factory=lambda: {"1.bin": LOG, "2.bin": b""})
    slow: bool = False
    written: list[tuple[str, bytes | None]] = field(default_factory=list)
    sequence: int = 0
    others: list[Peer] = field(default_factory=list)
    """Where else every client is."""

    def __post_init__(self) -> None:
        def pack(query: Query) -> bytes | None:
            return None if query.get("withdefaults") == "x" else b"packed" + repr(sorted(query.items())).encode()

        logs: Folder = SlowFolder(self.logs) if self.slow else MemoryFolder(self.logs)
        self.missions = MemoryFolder(
            {"old.plan": b"{old}"},
            accept=only_plans,
            changed=lambda name, data: self.written.append((name, data)),
        )
        self.tree = FileTree(
            GeneratedFolder({"general.json.xz": lambda query: GENERAL}),
            {"@PARAM": GeneratedFolder({"param.pck": pack}), "logs": logs, "missions": self.missions},
        )
        self.pacer = BulkPacer(lambda peer: self.rate)
        self.server = FtpServer(
            self.tree,
            system=1,
            component=1,
            pacer=self.pacer,
            allowed=lambda received, now: self.allowed,
            other_peers=lambda received, now: self.others,
        )

    def send(self, packet: FtpPacket, now: float = 0.0, **who: Any) -> list[FtpPacket]:
        """What is answered at once."""
        outgoing = self.server.receive(from_gcs(packet.message(1, 1), **who), now)
        return [parse_packet(each) for each in messages(outgoing)]

    def ask(self, op: int, data: bytes = b"", *, offset: int = 0, session: int = 0, **more: Any) -> FtpPacket:
        """The one answer to the next question."""
        self.sequence += 1
        who = {key: more.pop(key) for key in ("system", "peer", "now") if key in more}
        [answer] = self.send(FtpPacket(self.sequence, op, session, data, offset, **more), **who)
        assert (answer.req_opcode, answer.sequence) == (op, self.sequence + 1)
        return answer

    def tick(self, now: float) -> list[FtpPacket]:
        return [parse_packet(each) for each in messages(self.server.tick(now))]

    def stored(self, path: bytes) -> bytes:
        """A whole file."""
        place = self.tree.find(path)
        assert place is not None
        content = place.folder.open(place.name, place.query)
        assert content is not None
        data = content.read(0, content.size)
        assert data is not None
        return data


def error(packet: FtpPacket) -> FtpError:
    """Of a NAK."""
    assert packet.op == FtpOpcode.NAK
    [number] = packet.data
    return FtpError(number)


def as_entries(data: bytes) -> list[DirectoryEntry]:
    """The lines of a listing."""
    lines = [line.decode() for line in data.split(b"\0") if line]
    return [
        DirectoryEntry(line[1:], None)
        if line[0] == "D"
        else DirectoryEntry(line[1:].split("\t")[0], int(line.split("\t")[1]))
        for line in lines
    ]
