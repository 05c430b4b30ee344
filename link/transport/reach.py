"""Which endpoints only this computer, a cable or a private tunnel reaches, and which a whole network does."""

from __future__ import annotations

import contextlib
import fcntl
import socket
import struct
from collections.abc import Iterator
from importlib import import_module
from pathlib import Path

from link.endpoint import LISTENING, SCHEMES, SERIAL, Endpoint, is_loopback

INTERFACES = Path("/sys/class/net")
IPV6_ADDRESSES = Path("/proc/net/if_inet6")
POINT_TO_POINT = {"65534", "512", "65535"}
"""Kinds of interfaces without a shared medium: tunnels (WireGuard, Tailscale, OpenVPN tun), PPP, void."""
_SIOCGIFADDR = 0x8915


def is_private(endpoint: Endpoint) -> bool:
    """Return whether only this computer, the other end of a cable or a tunnel can send to an endpoint.

    A telemetry radio looks like a cable: who has its settings can send, too.
    """
    if (name := SCHEMES[endpoint.scheme].private) is not None:
        module, _, function = name.partition(":")
        return bool(getattr(import_module(module), function)(endpoint))
    if endpoint.scheme == SERIAL or is_loopback(endpoint.host):
        return True
    address = endpoint.host if endpoint.scheme in LISTENING else _source_address(endpoint)
    return address is not None and (is_loopback(address) or address in set(_tunnel_addresses()))


def _source_address(endpoint: Endpoint) -> str | None:
    """Return the address of ours from which the kernel would send; None if there is no way."""
    with contextlib.suppress(OSError, UnicodeError):  # opening the link says what is wrong with a host name
        for family, kind, _, _, place in socket.getaddrinfo(endpoint.host, endpoint.port, type=socket.SOCK_DGRAM):
            with contextlib.suppress(OSError), socket.socket(family, kind) as probe:
                probe.connect(place)  # sends nothing
                return str(probe.getsockname()[0])
    return None


def _tunnel_addresses() -> Iterator[str]:
    """Yield the addresses of this computer in tunnels."""
    tunnels = {name for _, name in socket.if_nameindex() if _is_tunnel(name)}
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as asking:
        for name in tunnels:
            with contextlib.suppress(OSError):
                answer = fcntl.ioctl(asking, _SIOCGIFADDR, struct.pack("256s", name.encode()[:15]))
                yield socket.inet_ntoa(answer[20:24])
    with contextlib.suppress(OSError):
        for line in IPV6_ADDRESSES.read_text().splitlines():
            digits, *_, name = line.split()
            if name in tunnels:
                yield socket.inet_ntop(socket.AF_INET6, bytes.fromhex(digits))


def _is_tunnel(name: str) -> bool:
    with contextlib.suppress(OSError):
        return (INTERFACES / name / "type").read_text().strip() in POINT_TO_POINT
    return False
