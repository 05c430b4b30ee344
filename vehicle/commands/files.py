"""MAVLink FTP, log download and component metadata: what ground stations read in bulk.

Joins the vehicle with the protocols of link/services; the content of each file comes from the module it belongs to.
"""

from __future__ import annotations

from collections.abc import Callable

from dialects import messages as m
from link.core import Outgoing, Received
from link.services import metadata
from link.services.ftp.files import FileTree, Folder, GeneratedFolder, Query
from link.services.ftp.server import FtpServer
from link.services.log.server import LogServer
from link.services.param.pack import pack
from link.signing.role import SigningRole
from vehicle.commands.access import Access
from vehicle.commands.context import Context
from vehicle.commands.inbound import InboundMessage, InboundTable, from_server
from vehicle.drive.ownership import Ownership
from vehicle.storage.logbook import Logbook
from vehicle.telemetry.build_status import VERSION
from vehicle.telemetry.view import TelemetryView

VENDOR, MODEL = "mavhelm", "rover"


class FileServices:
    """Serves files and logs. Anyone connected may read; only the driver may write."""

    def __init__(self, context: Context, logbook: Logbook, missions: Folder) -> None:
        system, component = context.ids
        pacer, table = context.pacer, context.params.table
        self._metadata = metadata.build_metadata(table, vendor=VENDOR, model=MODEL, version=".".join(map(str, VERSION)))
        described = GeneratedFolder({name: _constant(data) for name, data in self._metadata.files.items()})
        packed = GeneratedFolder({"param.pck": lambda query: pack(table, context.params, query)})
        self._ftp = FtpServer(
            FileTree(described, {"@PARAM": packed, "logs": logbook.folder(), "missions": missions}),
            system=system,
            component=component,
            pacer=context.file_pacer,
            allowed=lambda received, now: _may_write(received, context.control.ownership, now),
            other_peers=context.control.ownership.other_peers,
        )
        self._log = LogServer(
            logbook.recording.folder,
            system=system,
            component=component,
            pacer=pacer,
            when=logbook.recording.unix_time,
            erase=logbook.handle_log_erase,
        )

    def messages(self) -> InboundTable:
        """Return the rows of the messages handled here."""
        serve = from_server(self._log.receive)
        return (
            InboundMessage(m.FileTransferProtocol, Access.CONNECTED, "files; writing needs control",
                           from_server(self._ftp.receive)),
            InboundMessage(m.LogRequestList, Access.CONNECTED, "LOG_ENTRY for each log", serve),
            InboundMessage(m.LogRequestData, Access.CONNECTED, "LOG_DATA", serve),
            InboundMessage(m.LogRequestEnd, Access.CONNECTED, "ends LOG_DATA", serve),
            InboundMessage(m.LogErase, Access.DRIVER, "erases the logs while disarmed", serve,
                           checks_sender=True),
        )  # fmt: skip

    def tick(self, now: float) -> list[Outgoing]:
        """Return the next messages of running transfers, as far as the links have room."""
        return self._ftp.tick(now) + self._log.tick(now)

    def message_builders(self) -> dict[int, Callable[[TelemetryView], m.Message]]:
        """Return builders of what REQUEST_MESSAGE may ask for, by message id."""
        return {m.ComponentMetadata.id: lambda view: self._metadata.message(view.boot_ms)}


def _may_write(received: Received, ownership: Ownership, now: float) -> bool | None:
    """Return whether a sender may write; None: it is the driver, but its proof is missing at the moment."""
    if received.role < SigningRole.SET_UP:
        return False
    return None if ownership.missing_proof(received, now) else ownership.denial_reason(received, now) is None


def _constant(data: bytes) -> Callable[[Query], bytes]:
    return lambda query: data
