"""A fake vehicle with this project's own servers of files and logs, which send at a rate, in memory."""

from __future__ import annotations

from collections.abc import Sequence

from link.core import Received
from link.services.ftp.files import FileTree, MemoryFolder
from link.services.ftp.server import FtpServer
from link.services.log.server import LogServer
from link.services.pacing import BulkPacer
from tests.fakes.vehicle import FakeVehicle


class Servers:
    """Servers of link/services as a part of a vehicle."""

    def __init__(self, servers: Sequence[FtpServer | LogServer]) -> None:
        self._servers = servers

    def receive(self, vehicle: FakeVehicle, received: Received, now: float) -> None:
        """Pass it on to the servers."""
        for server in self._servers:
            vehicle.outbox.extend(server.receive(received, now))

    def tick(self, vehicle: FakeVehicle, now: float) -> None:
        """Let the servers send."""
        for server in self._servers:
            vehicle.outbox.extend(server.tick(now))


class FileVehicle(FakeVehicle):
    """`rate` in bytes/s is what its servers send. `ftp`: it has a file service."""

    def __init__(self, *, rate: float = 50_000.0, ftp: bool = True, autopilot: int = 0) -> None:
        self.logs = MemoryFolder()
        self.scripts = MemoryFolder(accept=lambda name, data: None)
        self.erasable = True
        pacer = BulkPacer(lambda peer: rate)
        tree = FileTree(MemoryFolder(), {"logs": self.logs, "scripts": self.scripts})
        servers: list[FtpServer | LogServer] = [FtpServer(tree, system=1, component=1, pacer=pacer)] if ftp else []
        servers.append(
            LogServer(self.logs, system=1, component=1, pacer=pacer, when=lambda name: 1_700_000_000, erase=self._erase)
        )
        super().__init__(autopilot=autopilot, parts=[Servers(servers)])

    def _erase(self, received: Received, now: float) -> None:
        if self.erasable:
            self.logs.files.clear()
