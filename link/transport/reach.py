"""Which endpoints only this computer, a cable or a private tunnel reaches, and why; all others a whole network reaches.

The kind of a device says this of WireGuard alone. Mobile modems look like other tunnels (PPP, or no link layer), and
everybody behind them like its other end, so that the file names what else is private.
"""

from __future__ import annotations

import contextlib
import fcntl
import ipaddress
import re
import socket
import struct
import sys
from array import array
from collections.abc import Collection, Iterator
from importlib import import_module
from pathlib import Path

import msgspec

from link.endpoint import LISTENING, SCHEMES, SERIAL, Endpoint, is_loopback

INTERFACES = Path("/sys/class/net")
IPV6_ADDRESSES = Path("/proc/net/if_inet6")
WIREGUARD = "DEVTYPE=wireguard"
"""A line of `uevent` in the folder of an interface (Linux, drivers/net/wireguard/device.c)."""
LOOPBACK = "lo"
NAME = r"[^\s/:*?\[\]]{1,15}"
"""What an interface may be called (Linux, dev_valid_name), less what would be a pattern."""

_SIOCGIFCONF = 0x8912
_IFREQ = 40
"""Bytes of `struct ifreq` on 64 bits; `struct sockaddr` is behind 16 bytes of name."""
_MOST = 256
"""Addresses that are read."""


class Trust(msgspec.Struct, frozen=True):
    """Why no stranger can send to an endpoint."""

    reason: str
    """e.g. "wg0 is WireGuard"."""
    device: str = ""
    """Interface to which its sockets must be bound: Linux accepts packets to an address of ours on every interface."""


def find_trust(endpoint: Endpoint, private: Collection[str] = ()) -> Trust | None:
    """Return why only this computer, the other end of a cable or a tunnel can send to an endpoint; None: others can.

    `private`: interfaces that the user trusts. A telemetry radio looks like a cable: who has its settings sends, too.
    """
    if (name := SCHEMES[endpoint.scheme].private) is not None:
        module, _, function = name.partition(":")
        asks = getattr(import_module(module), function)(endpoint)
        return Trust("its router asks everybody for a certificate") if asks else None
    if endpoint.scheme == SERIAL:
        return Trust("a cable")
    if is_loopback(endpoint.host):
        return Trust("only this computer")
    address = endpoint.host if endpoint.scheme in LISTENING else _source_address(endpoint)
    found = None if address is None else _canonical(address)
    return next(filter(None, (_trust_of(name, private) for name, each in _addresses() if each == found)), None)


def missing_interfaces(private: Collection[str]) -> list[str]:
    """Return those of these interfaces that this computer does not have now."""
    # Not by if_nameindex(): it needs AF_NETLINK, which the unit of the vehicle forbids.
    return [name for name in private if not _has_interface(name)]


def _has_interface(name: str) -> bool:
    try:
        return socket.if_nametoindex(name) > 0
    except OSError:
        return False


def is_interface_name(text: str) -> bool:
    """Return whether an interface may be called like this; a pattern is not a name."""
    return re.fullmatch(NAME, text) is not None and text not in (".", "..")


def _trust_of(name: str, private: Collection[str]) -> Trust | None:
    """Return why an interface is trusted, or None."""
    if name == LOOPBACK:
        return Trust("only this computer", LOOPBACK)
    if name in private:
        return Trust(f"{name} is named in private under [signing]", name)
    with contextlib.suppress(OSError):
        if WIREGUARD in (INTERFACES / name / "uevent").read_text().splitlines():
            return Trust(f"{name} is WireGuard", name)
    return None


def _source_address(endpoint: Endpoint) -> str | None:
    """Return the address of ours from which the kernel would send; None if there is no way."""
    with contextlib.suppress(OSError, UnicodeError):  # opening the link says what is wrong with a host name
        for family, kind, _, _, place in socket.getaddrinfo(endpoint.host, endpoint.port, type=socket.SOCK_DGRAM):
            with contextlib.suppress(OSError), socket.socket(family, kind) as probe:
                probe.connect(place)  # sends nothing
                return str(probe.getsockname()[0])
    return None


def _addresses() -> Iterator[tuple[str, str]]:
    """Yield each interface of this computer with each of its addresses; none on other systems than Linux.

    There is no trust in an interface there: packets to its address are accepted on others, too.
    """
    if sys.platform != "linux":
        return
    room = array("B", bytes(_IFREQ * _MOST))
    with contextlib.suppress(OSError), socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as asking:
        answer = fcntl.ioctl(asking, _SIOCGIFCONF, struct.pack("iL", len(room), room.buffer_info()[0]))
        (used,) = struct.unpack_from("i", answer)
        for at in range(0, used, _IFREQ):
            name = room[at : at + 16].tobytes().split(b"\0", 1)[0].decode(errors="replace")
            yield name.partition(":")[0], socket.inet_ntoa(room[at + 20 : at + 24])  # "wg0:1" is a label of wg0
    with contextlib.suppress(OSError):
        for line in IPV6_ADDRESSES.read_text().splitlines():
            digits, *_, name = line.split()
            yield name, socket.inet_ntop(socket.AF_INET6, bytes.fromhex(digits))


def _canonical(address: str) -> str:
    """Return an address as _addresses() writes it."""
    try:
        return str(ipaddress.ip_address(address.partition("%")[0]))
    except ValueError:
        return address
