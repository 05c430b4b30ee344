"""Opens wires: the table of what opens each kind of endpoint."""

from __future__ import annotations

from collections.abc import Sequence

from link.endpoint import parse
from link.transport.serial import open_serial
from link.transport.tcp import open_tcpin, open_tcpout
from link.transport.transport import LinkError, Opener, Wire
from link.transport.udp import open_udp

OPENERS: dict[str, Opener] = {
    "udpin": open_udp,
    "udpout": open_udp,
    "tcpin": open_tcpin,
    "tcpout": open_tcpout,
    "serial": open_serial,
}
"""Scheme of link/endpoint.py -> what opens it."""


def open_wires(endpoints: Sequence[str]) -> list[Wire]:
    """Open all endpoints, or none: raises EndpointError or LinkError."""
    parsed = [parse(text) for text in endpoints]
    wires: list[Wire] = []
    try:
        wires.extend(OPENERS[endpoint.scheme](endpoint) for endpoint in parsed)
    except LinkError:
        for wire in wires:
            wire.close()
        raise
    return wires
