"""Host name lookup, and the error texts of socket addresses, for UDP and TCP."""

from __future__ import annotations

import errno
import socket

from link.endpoint import LISTENING, Endpoint
from link.transport.transport import LinkError, PortInUseError

PRIVILEGED = 1024
"""Ports below need root (ip(7), ip_unprivileged_port_start)."""
LIMITED_BROADCAST = "255.255.255.255"
"""Without any route it is unreachable, too (RFC 919)."""


def resolve(endpoint: Endpoint, kind: socket.SocketKind) -> tuple[tuple[str, int], socket.AddressFamily]:
    """Look up the address of `endpoint`. Raises LinkError."""
    try:
        # Python encodes a text as IDNA, whose tables take 1 ms to import; an IPv4 address is given as it is.
        numeric = endpoint.host.isascii() and endpoint.host.replace(".", "").isdigit()
        found = socket.getaddrinfo(endpoint.host.encode() if numeric else endpoint.host, endpoint.port, type=kind)
    except (OSError, UnicodeError) as error:
        raise LinkError(
            f"{endpoint.text}: host {endpoint.host!r} is not known; check the name or use its IP address"
        ) from error
    family, _, _, _, address = found[0]
    return (str(address[0]), int(address[1])), family


def bind_error(endpoint: Endpoint, error: OSError) -> LinkError:
    """Return the error of a socket that could not be opened."""
    if error.errno == errno.EADDRINUSE:
        return PortInUseError(
            f"{endpoint.text}: port {endpoint.port} is in use; "
            "stop the other program (`ss -lnp` lists it) or choose another port"
        )
    return LinkError(_bind_error_text(endpoint, error))


def _bind_error_text(endpoint: Endpoint, error: OSError) -> str:
    if error.errno == errno.EADDRNOTAVAIL:
        return (
            f"{endpoint.text}: {endpoint.host} is not an address of this machine; "
            "use one of its own, or 0.0.0.0 for all of them"
        )
    broadcast = error.errno == errno.EACCES or endpoint.host == LIMITED_BROADCAST  # socket(7): without SO_BROADCAST
    if broadcast and endpoint.scheme == "udpout":
        return f"{endpoint.text}: {endpoint.host} is a broadcast address; name one machine, or listen with udpin"
    if error.errno in (errno.EACCES, errno.EPERM) and endpoint.scheme in LISTENING and endpoint.port < PRIVILEGED:
        return f"{endpoint.text}: not allowed; ports below {PRIVILEGED} need root, choose a higher one"
    if error.errno in (errno.EACCES, errno.EPERM):
        return f"{endpoint.text}: this system does not allow it; a firewall or a sandbox may forbid it"
    return f"{endpoint.text}: {error.strerror}"
