"""Opens wires: the table of what opens each kind of endpoint."""

from __future__ import annotations

from collections.abc import Sequence

from link.endpoint import parse_endpoint
from link.transport.serial import open_serial
from link.transport.tcp import open_tcpin, open_tcpout
from link.transport.transport import LinkError, Transport, TransportFactory
from link.transport.udp import open_udp

TRANSPORTS: dict[str, TransportFactory] = {
    "udpin": open_udp,
    "udpout": open_udp,
    "tcpin": open_tcpin,
    "tcpout": open_tcpout,
    "serial": open_serial,
}
"""Scheme of link/endpoint.py -> what opens it."""


def open_transports(endpoints: Sequence[str]) -> list[Transport]:
    """Open all endpoints, or none: raises EndpointError or LinkError."""
    parsed = [parse_endpoint(text) for text in endpoints]
    wires: list[Transport] = []
    try:
        wires.extend(TRANSPORTS[endpoint.scheme](endpoint) for endpoint in parsed)
    except LinkError:
        for wire in wires:
            wire.close()
        raise
    return wires
