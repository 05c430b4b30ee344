"""VerbSet: the verbs that go through a station."""

from __future__ import annotations

import asyncio
import socket
from collections.abc import Callable

from groundstation.host.verb_port import VerbPort
from groundstation.station.station import Station
from groundstation.station_socket.hello import Hello
from groundstation.station_socket.relay import VerbReady


class VerbSet:
    """`ids` are those of the station; `flush` sends what verbs have queued."""

    def __init__(self, station: Station, ids: tuple[int, int], flush: Callable[[], None]) -> None:
        self._station = station
        self._ids = ids
        self._flush = flush
        self._ports: set[VerbPort] = set()

    def add(self, sock: socket.socket, name: str, hello: Hello) -> None:
        """Take a verb; the loop runs."""
        station = self._station
        follows = hello.follows and station.relay.may_follow(asyncio.get_running_loop().time())
        port = VerbPort(sock, station.relay, (name, hello.takes_part, follows), self._flush, self._remove)
        self._ports.add(port)
        port.start(VerbReady(*self._ids, station.operator.session, station.surroundings.endpoints, follows))

    def close(self) -> None:
        """End all connections."""
        for port in list(self._ports):
            self._remove(port)

    def _remove(self, port: VerbPort) -> None:
        self._ports.discard(port)
        port.close()
        self._flush()
