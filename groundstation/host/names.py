"""Answers a shell that completes a word: the names that the station knows, from memory. No vehicle is asked."""

from __future__ import annotations

import contextlib
import socket
from collections.abc import Callable, Iterable, Mapping

from groundstation.station.station import Station
from groundstation.station_socket.names import MODES, PARAMS, VEHICLES, Names, encode_names
from groundstation.vehicles.requests.mode_requests import listed_or_known


def answer_names(sock: socket.socket, kind: str, station: Station) -> None:
    """Send the names of this kind, none of an unknown kind, and close the connection."""
    names = tuple(sorted(set(_SOURCES[kind](station)))) if kind in _SOURCES else ()
    with sock, contextlib.suppress(OSError):  # the shell waits no longer
        sock.send(encode_names(Names(names)))


def _params(station: Station) -> Iterable[str]:
    """Return those heard, and those that came in a file (MAVLink FTP)."""
    services = [contact.services for contact in station.fleet if contact.services is not None]
    return station.params.names.union(*(each.params.client.params for each in services))


def _modes(station: Station) -> Iterable[str]:
    for contact in station.fleet:
        model = (contact.state.autopilot, contact.state.kind)
        identity = contact.services.identity if contact.services else None
        yield from (mode.name for mode in listed_or_known(identity, model))


def _vehicles(station: Station) -> Iterable[str]:
    return (contact.state.fleet_name or str(contact.state.system) for contact in station.fleet)


_SOURCES: Mapping[str, Callable[[Station], Iterable[str]]] = {PARAMS: _params, MODES: _modes, VEHICLES: _vehicles}
"""Kind of names -> where they are."""
