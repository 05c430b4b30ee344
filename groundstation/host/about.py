"""Answers a program that describes several stations: vehicles, links and screens of this one."""

from __future__ import annotations

import contextlib
import socket

from groundstation.host.screens import ScreenSet
from groundstation.station.station import Station
from groundstation.station_socket.about import About, encode_about


def answer_about(sock: socket.socket, station: Station, screens: ScreenSet) -> None:
    """Send what this station is, and close the connection."""
    selected = station.fleet.selected
    others = [contact for contact in station.fleet if contact is not selected]
    contacts = others if selected is None else [selected, *others]
    about = About(tuple(each.state.name for each in contacts), station.station_info.endpoints, screens.names)
    with sock, contextlib.suppress(OSError):  # the program waits no longer
        sock.send(encode_about(about))
