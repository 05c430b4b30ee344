"""The station's sockets and serial ports in the watchdog's process: copies of the descriptors, to write and to read."""

from __future__ import annotations

import contextlib
import os
import socket
from collections.abc import Sequence

from groundstation.watchdog.report import DemandRoute
from groundstation.watchdog.watchdog import WANTED
from link.protocol.frame import Frame
from link.protocol.framer import Framer

READ = 65536


class Outlets:
    """The routes of the newest report, with their descriptors."""

    def __init__(self) -> None:
        self._descriptors: list[int] = []
        self._routes: tuple[DemandRoute, ...] = ()
        self._framers: dict[int, Framer] = {}

    def update(self, routes: tuple[DemandRoute, ...]) -> None:
        """Store the routes of a report that has the descriptors of the one before."""
        self._routes = routes

    def replace(self, descriptors: Sequence[int], routes: tuple[DemandRoute, ...]) -> None:
        """Store the descriptors of a report and close those of the one before."""
        for descriptor in self._descriptors:
            with contextlib.suppress(OSError):
                os.close(descriptor)
        self._descriptors, self._routes = list(descriptors), routes
        self._framers.clear()

    @property
    def descriptors(self) -> tuple[int, ...]:
        """The descriptors, to wait on."""
        return tuple(self._descriptors)

    def write(self, route: int, frame: bytes) -> str | None:
        """Send one frame; return why the kernel did not accept it, or None."""
        if route >= len(self._descriptors):
            return "no descriptor"
        try:
            _send(self._descriptors[route], self._routes[route].destination, frame)
        except OSError as error:
            return error.strerror or str(error)
        return None

    def read(self, descriptor: int, now: float) -> list[Frame]:
        """Return the frames that have arrived. Raises OSError, and EOFError at the end of a stream."""
        data = os.read(descriptor, READ)
        if not data:
            raise EOFError
        framer = self._framers.setdefault(descriptor, Framer(stream=True))
        return [frame for frame in framer.feed(data, now) if frame[0] in WANTED]


def _send(descriptor: int, destination: tuple[str | int, ...] | None, frame: bytes) -> None:
    if destination is None:
        os.write(descriptor, frame)
        return
    outlet = socket.socket(fileno=descriptor)
    try:
        outlet.sendto(frame, destination)
    finally:
        outlet.detach()
