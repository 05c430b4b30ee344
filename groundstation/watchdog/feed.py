"""Reports to the watchdog what the station drives and where the demands leave, with the descriptors."""

from __future__ import annotations

import contextlib
import errno
import logging
import os
import socket
import time
from collections.abc import Callable, Hashable, Sequence
from typing import Any

from dialects.enums import OperatorFlag
from dialects.messages import ManualControl, Message, RcChannelsOverride, RoverOperatorPresence
from groundstation.station.driving.driven import DEMAND_MEMORY, WatchdogTarget
from groundstation.watchdog.process import fork_watchdog
from groundstation.watchdog.report import MAX_OUTLETS, DemandRoute, StationReport, encode_report
from link.signing.signing import Signing
from link.transport.transport import Link

log = logging.getLogger(__name__)

END_WITHIN = 0.3
"""s for the watchdog to end after the station's last report: the ports must be free when the station has ended."""

MAX_ADDRESSES = 256
"""Addresses whose sequence is remembered; a link has 24 at a time."""

GONE = (errno.EPIPE, errno.ECONNRESET, errno.ENOTCONN, errno.ECONNREFUSED)
"""Errors that show that the watchdog's process has ended."""


class WatchdogFeed:
    """The watchdog of this process. `ids` are our system and component id."""

    def __init__(self, process: int, sock: socket.socket, ids: tuple[int, int]) -> None:
        self._process = process
        self._socket = sock
        self._ids = ids
        self._sequences: dict[tuple[int, Hashable], int] = {}
        """Link and address -> packet sequence of the newest frame."""
        self._routes: dict[tuple[int, int, Hashable], tuple[Link, float]] = {}
        """System, link and address -> the link, and when the newest demand went there."""
        self._handed_over: list[tuple[int, object]] = []
        """Descriptors that the watchdog has, and the socket or port of each."""
        self._flags: dict[str, Any] = {}
        self.alive = True

    @classmethod
    def start(
        cls,
        screen: socket.socket | None,
        terminal: str | None,
        ids: tuple[int, int],
        signing: Signing | None = None,
        read_keys: Callable[[], None] | None = None,
        of_station: socket.socket | None = None,
    ) -> WatchdogFeed:
        """Start the watchdog, which signs with the same keys. Raises OSError.

        `screen` leads to the screen, if there is one, for the watchdog alone, `of_station` for the station alone.
        `read_keys` reads other keys into `signing` in the watchdog's process, when `set_flags(keys_version=)` says so.
        """
        return cls(*fork_watchdog(screen, terminal, signing, read_keys, of_station), ids)

    def record_sent(self, link: Link, address: Hashable, message: Message, sequence: int, now: float) -> None:
        """Record a frame that was sent, and with a demand the way to its vehicle."""
        index = link.channel.index
        if len(self._sequences) > MAX_ADDRESSES:
            self._sequences.clear()
        self._sequences[index, address] = sequence
        if isinstance(message, ManualControl):
            self._routes[message.target, index, address] = (link, now)
        elif isinstance(message, RoverOperatorPresence):  # over all links; MANUAL_CONTROL beside it goes over one
            if message.flags & OperatorFlag.AXES:
                self._routes[message.target_system, index, address] = (link, now)
        elif isinstance(message, RcChannelsOverride):  # neutral in MANUAL_CONTROL also ends what ArduPilot holds of it
            self._routes[message.target_system, index, address] = (link, now)

    def set_flags(self, **flags: bool | int) -> None:
        """Set fields that all further reports have."""
        self._flags |= flags

    def report(self, vehicles: Sequence[WatchdogTarget], now: float, *, rests: bool = False) -> bool:
        """Report that the station runs, and if it rests. Returns False once, when the watchdog's process has ended."""
        self._forget_old(now)
        routes: list[DemandRoute] = []
        opened: list[tuple[int, object]] = []
        for number, vehicle in enumerate(vehicles):
            for (system, index, address), (link, _) in self._routes.items():
                outlet = link.transport.outlet(address) if system == vehicle.system else None
                if outlet is not None and outlet.descriptor >= 0 and len(routes) < MAX_OUTLETS:
                    sequence = self._sequences.get((index, address), 0)
                    way = link.channel.signing_way(address, now)
                    old = link.channel.speaks_version_1(address, system)
                    routes.append(DemandRoute(number, outlet.destination, sequence, way, old))
                    opened.append((outlet.descriptor, outlet.opened))
        keeps = opened == self._handed_over
        data = encode_report(
            StationReport(
                ids=self._ids,
                vehicles=tuple(vehicles),
                routes=tuple(routes),
                keeps_descriptors=keeps,
                rests=rests,
                **self._flags,
            )
        )
        return self._send(data, None if keeps else opened)

    def close(self) -> None:
        """Tell the watchdog that the station ends in order, and wait for its end."""
        self.set_flags(ending=True)
        self.report((), 0.0)
        self._socket.close()
        deadline = time.monotonic() + END_WITHIN
        with contextlib.suppress(ChildProcessError):
            while os.waitpid(self._process, os.WNOHANG)[0] == 0 and time.monotonic() < deadline:
                time.sleep(0.005)

    def _forget_old(self, now: float) -> None:
        for key in [key for key, (_, at) in self._routes.items() if now - at > DEMAND_MEMORY]:
            del self._routes[key]

    def _send(self, data: bytes, opened: list[tuple[int, object]] | None) -> bool:
        """Send a report, with the descriptors of `opened` unless that is None."""
        was_alive = self.alive
        try:
            if opened is None:
                self._socket.send(data)
            else:
                socket.send_fds(self._socket, [data], [descriptor for descriptor, _ in opened])
                self._handed_over = opened  # not after an error: they travel with the next report then
        except OSError as error:  # among others: the watchdog stands still, and its queue is full
            self.alive = self.alive and error.errno not in GONE
            log.warning("no report to the watchdog: %s", error.strerror)
        return self.alive or not was_alive
