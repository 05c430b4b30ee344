"""ProgramSet: the programs that use a station: screens, verbs, and shells that ask for names or for what runs."""

from __future__ import annotations

import asyncio
import contextlib
import os
import socket
from collections.abc import Callable, Iterable, Mapping

from groundstation.host.listener import Caller, ProgramListener
from groundstation.host.run_port import RunPort
from groundstation.host.screens import ScreenSet
from groundstation.ipc import protocol_version
from groundstation.station.station import Station
from groundstation.station_socket import about, names, verb_run
from groundstation.station_socket.about import About, encode_about
from groundstation.station_socket.hello import ABOUT, NAMES, SCREEN, VERB, Hello
from groundstation.station_socket.names import MODES, PARAMS, VEHICLES, Names, encode_names
from groundstation.station_socket.verb_run import VerbReady
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


def answer_about(sock: socket.socket, station: Station, screens: ScreenSet) -> None:
    """Send what this station is, and close the connection."""
    selected = station.fleet.selected
    others = [contact for contact in station.fleet if contact is not selected]
    contacts = others if selected is None else [selected, *others]
    about = About(tuple(each.state.name for each in contacts), station.station_info.endpoints, screens.names)
    with sock, contextlib.suppress(OSError):  # the program waits no longer
        sock.send(encode_about(about))


class VerbSet:
    """Verbs of shells, which run in a station. `flush` sends what verbs have queued."""

    def __init__(self, station: Station, flush: Callable[[], None]) -> None:
        self._station = station
        self._flush = flush
        self._ports: set[RunPort] = set()

    def add(self, sock: socket.socket, name: str, hello: Hello) -> None:
        """Start a verb; the loop runs."""
        station = self._station
        follows = hello.follows and station.verbs.may_follow(asyncio.get_running_loop().time())
        port = RunPort(sock, station, name, self._flush, self._remove, follows=follows)
        self._ports.add(port)
        port.start(VerbReady(station.station_info.endpoints))

    def close(self) -> None:
        """End all connections."""
        for port in list(self._ports):
            self._remove(port)

    def _remove(self, port: RunPort) -> None:
        self._ports.discard(port)
        port.close()
        self._flush()


class ProgramSet:
    """All programs of one station. `flush` as that of VerbSet."""

    def __init__(self, station: Station, screens: ScreenSet, flush: Callable[[], None]) -> None:
        self._station = station
        self._screens = screens
        self._verbs = VerbSet(station, flush)
        self._listener = ProgramListener(self._take)
        self._screen_version = protocol_version()  # of the code that runs, not of what is installed meanwhile
        self._ending = False

    def start(self) -> str | None:
        """Listen; the loop runs. Return why that is not possible."""
        return self._listener.start()

    def refuse(self) -> None:
        """Refuse further programs: the station ends."""
        self._ending = True

    def end_verbs(self) -> None:
        """End all verbs."""
        self._verbs.close()

    def close(self) -> None:
        """End all connections."""
        self._listener.close()
        self._screens.close()
        self._verbs.close()

    def _take(self, caller: Caller) -> str | None:
        """Add a program that has connected. Return why not."""
        hello = caller.hello
        if self._ending:
            return "this station ends"
        versions = {SCREEN: self._screen_version, VERB: verb_run.VERSION, NAMES: names.VERSION,
                    ABOUT: about.VERSION}  # fmt: skip
        if hello.version != versions.get(hello.kind):
            return f"this station (pid {os.getpid()}) has another version: end it and start it again"
        if hello.kind == SCREEN:
            return self._screens.add(caller.sock, hello.name, watches=hello.watches)
        if hello.kind == NAMES:
            answer_names(caller.sock, hello.name, self._station)
            return None
        if hello.kind == ABOUT:
            answer_about(caller.sock, self._station, self._screens)
            return None
        self._verbs.add(caller.sock, f"{hello.name} (pid {caller.pid})", hello)
        return None
