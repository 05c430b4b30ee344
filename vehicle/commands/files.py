"""What ground stations read at length: files by MAVLink FTP, logs, and what the parameters mean.

It joins the vehicle with the protocols of link/services; what is in a file is its maker's matter.
"""

from __future__ import annotations

from collections.abc import Callable

from dialects import messages as m
from link.core import Outgoing, Received
from link.services import metadata
from link.services.ftp.files import FileTree, Folder, GeneratedFolder, Query
from link.services.ftp.server import FtpServer
from link.services.log.server import LogServer
from link.services.pacing import BulkPacer
from link.services.param.pack import pack
from vehicle.drive.control import Control
from vehicle.params import Params
from vehicle.storage.logbook import Logbook
from vehicle.telemetry.build_status import VERSION
from vehicle.telemetry.view import TelemetryView

VENDOR, MODEL = "mavhelm", "rover"


class FileServices:
    """Answers for one system and component. Reading is for everybody, writing for the driver in control."""

    def __init__(
        self,
        params: Params,
        control: Control,
        logbook: Logbook,
        *,
        missions: Folder,
        ids: tuple[int, int],
        pacer: BulkPacer,
    ) -> None:
        system, component = ids
        table = params.table
        self._metadata = metadata.build_metadata(table, vendor=VENDOR, model=MODEL, version=".".join(map(str, VERSION)))
        described = GeneratedFolder({name: _constant(data) for name, data in self._metadata.files.items()})
        packed = GeneratedFolder({"param.pck": lambda query: pack(table, params, query)})
        self._ftp = FtpServer(
            FileTree(described, {"@PARAM": packed, "logs": logbook.folder(), "missions": missions}),
            system=system,
            component=component,
            pacer=pacer,
            allowed=lambda received: control.denial_reason(received.system) is None,
        )
        self._log = LogServer(
            logbook.recording.folder,
            system=system,
            component=component,
            pacer=pacer,
            when=logbook.recording.unix_time,
            erase=logbook.handle_log_erase,
        )

    def receive(self, received: Received, now: float) -> list[Outgoing]:
        """Answer one message."""
        return self._ftp.receive(received, now) + self._log.receive(received, now)

    def tick(self, now: float) -> list[Outgoing]:
        """The next of what is under way, as far as the links have room."""
        return self._ftp.tick(now) + self._log.tick(now)

    def message_builders(self) -> dict[int, Callable[[TelemetryView], m.Message]]:
        """What REQUEST_MESSAGE may ask for, by id."""
        return {m.ComponentMetadata.id: lambda view: self._metadata.message(view.boot_ms)}


def _constant(data: bytes) -> Callable[[Query], bytes]:
    return lambda query: data
