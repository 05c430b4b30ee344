"""PortScan: the serial ports of this machine, read again and again in a thread."""

from __future__ import annotations

from collections.abc import Callable

from groundstation.station_socket.connect import running_stations
from groundstation.station_socket.folder import FolderError
from groundstation.views.connect import PortRow
from link.runtime.worker import Worker
from link.transport.serial_ports import SerialPort, find_serial_ports

PERIOD = 1.0
"""s between two scans: a radio that is plugged in is listed while the user looks."""


class PortScan:
    """Reads the ports while somebody wants to know."""

    def __init__(self, find: Callable[[], list[SerialPort]] = find_serial_ports) -> None:
        self._find = find
        self._worker = Worker("serial ports", 1)
        self._due = 0.0
        self.rows: tuple[PortRow, ...] = ()
        """What the newest scan has found."""

    def look(self, now: float) -> None:
        """Scan again if it is due; a slow scan delays the next one."""
        if now >= self._due:
            self._due = now + PERIOD
            self._worker.submit(self._scan)

    def close(self) -> None:
        """End the thread."""
        self._worker.close(patience=0.0)

    def _scan(self) -> None:
        ports = self._find()
        stations = _own_stations() if any(each.holder for each in ports) else []
        self.rows = tuple(
            PortRow(
                path=each.path,
                description=each.description,
                ids=each.ids,
                driver=each.driver,
                holder=each.holder,
                station=next((pid for pid in stations if each.holder.endswith(f"(pid {pid})")), 0),
                allowed=each.allowed,
            )
            for each in ports
        )


def _own_stations() -> list[int]:
    try:
        return running_stations()
    except FolderError:
        return []
