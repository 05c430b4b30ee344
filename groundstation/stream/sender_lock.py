"""Whose packets are pictures: RTP has no password, and whoever reaches the port can send to it. Time is an argument."""

from __future__ import annotations

from collections.abc import Iterable
from functools import lru_cache
from ipaddress import IPv6Address, ip_address

SILENT_AFTER = 2.0
"""s without a packet after which another sender may begin."""


@lru_cache(64)
def clean_host(host: str) -> str:
    """Return an IP address as it is compared: without a zone, IPv4 also where a socket of IPv6 has received it."""
    try:
        address = ip_address(host.partition("%")[0])
    except ValueError:
        return host
    mapped = address.ipv4_mapped if isinstance(address, IPv6Address) else None
    return str(mapped or address)


def choose_senders(hosts: Iterable[str]) -> tuple[str, ...]:
    """Return who may send, by the addresses of a vehicle's links; () for any one.

    One that is reached through this machine, as by a bridge, has an address that no link tells.
    """
    found = sorted({clean_host(host) for host in hosts})
    return () if any(_is_loopback(host) for host in found) else tuple(found)


@lru_cache(64)
def _is_loopback(host: str) -> bool:
    try:
        return ip_address(host).is_loopback
    except ValueError:
        return True  # a name: its address is not known


class SenderLock:
    """Lets packets of the given senders pass; without any, those of the first one until it is silent."""

    def __init__(self, allowed: tuple[str, ...] = ()) -> None:
        self.allowed = allowed
        self.refused = ""
        """The newest sender that was refused since the last packet that passed."""
        self._sender = ""
        self._heard_at = 0.0

    def passes(self, host: str, now: float) -> bool:
        """Return whether a packet of this address is of the stream."""
        host = clean_host(host)
        if self.allowed:
            passes = host in self.allowed
        else:
            if now - self._heard_at > SILENT_AFTER or not self._sender:
                self._sender = host
            passes = host == self._sender
        if passes:
            self._heard_at, self.refused = now, ""
        else:
            self.refused = host
        return passes

    def complaint(self, now: float) -> str:
        """Return what is wrong if only others than the given senders send, in one line; "" else."""
        if not self.allowed or not self.refused or now - self._heard_at <= SILENT_AFTER:
            return ""
        return f"pictures come from {self.refused}, not from the vehicle at {' or '.join(self.allowed)}: refused"
