"""PortScan: the serial ports of this machine, read again and again in a thread."""

from __future__ import annotations

from collections.abc import Callable

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
        self.rows = tuple(
            PortRow(
                path=each.path,
                description=each.description,
                ids=each.ids,
                driver=each.driver,
                holder=each.holder,
                allowed=each.allowed,
            )
            for each in self._find()
        )
