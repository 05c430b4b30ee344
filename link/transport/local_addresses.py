"""IPv4 addresses of this machine, for texts that tell a user where a vehicle must send to."""

from __future__ import annotations

import contextlib
import fcntl
import math
import socket
import struct
import sys

SIOCGIFADDR = {"linux": 0x8915, "darwin": 0xC0206921}
"""The request for the address of an interface: Linux (netdevice(7)), macOS (<sys/sockio.h>)."""

PERIOD = 2.0
"""s between two lookups: a network may come up while the program waits."""

_DOCUMENTATION = ("192.0.2.1", 9)
"""An address that no network has (RFC 5737). Connecting a UDP socket to it sends nothing, and selects a route."""


class LocalAddresses:
    """The addresses of this machine without loopback, that of the default route first; looked up again now and then."""

    def __init__(self) -> None:
        self._found: tuple[str, ...] = ()
        self._due = -math.inf

    def find(self, now: float) -> tuple[str, ...]:
        """Return the addresses, at most PERIOD old. Never blocks; takes 0.1 ms."""
        if now >= self._due:
            self._found, self._due = _find_addresses(), now + PERIOD
        return self._found


def _find_addresses() -> tuple[str, ...]:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        found = [*_interface_addresses(probe)]
        with contextlib.suppress(OSError):  # without a default route there is no such address
            probe.connect(_DOCUMENTATION)
            found.insert(0, str(probe.getsockname()[0]))
    return tuple(address for address in dict.fromkeys(found) if not address.startswith("127."))


def _interface_addresses(probe: socket.socket) -> list[str]:
    """Return one address of each interface; none on other systems, whose request differs."""
    if (request := SIOCGIFADDR.get(sys.platform)) is None:
        return []
    addresses: list[str] = []
    for _, name in socket.if_nameindex():
        with contextlib.suppress(OSError):  # an interface without an address
            answer = fcntl.ioctl(probe.fileno(), request, struct.pack("256s", name.encode()[:15]))
            addresses.append(socket.inet_ntoa(answer[20:24]))
    return addresses
