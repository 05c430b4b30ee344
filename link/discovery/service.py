"""MavlinkService: what an end of a link announces about itself, and what is read from others. No network.

The types are those that other ground stations use. The TXT record (RFC 6763) has `sysid`, `role` and `name`.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from enum import StrEnum

import msgspec

from dialects.printable import printable
from link.endpoint import LISTENING, Endpoint, is_loopback

TYPES = {"udp": "_mavlink._udp.local.", "tcp": "_mavlink._tcp.local."}
"""Transport -> type of the service."""

MAX_NAME = 40
"""Characters of a name that are shown; a label of DNS has 63 bytes."""


class ServiceRole(StrEnum):
    """What listens there."""

    VEHICLE = "vehicle"
    GROUND_STATION = "gcs"
    UNKNOWN = ""


class MavlinkService(msgspec.Struct, frozen=True):
    """One end that listens."""

    name: str
    """Of the vehicle or program, e.g. "Rover 1 on field-pi"; printable."""
    host: str
    """Address; "" for one that was not resolved."""
    port: int
    transport: str = "udp"
    system: int = 0
    """System id; 0 if it is not announced."""
    role: ServiceRole = ServiceRole.UNKNOWN

    @property
    def endpoint(self) -> str:
        """The endpoint that connects to it."""
        host = f"[{self.host}]" if ":" in self.host else self.host
        return f"{self.transport}out:{host}:{self.port}"

    @property
    def txt(self) -> dict[str, str]:
        """The TXT record."""
        return {"sysid": str(self.system), "role": self.role.value, "name": self.name}


def can_announce(endpoint: Endpoint) -> bool:
    """Return whether others can connect to this endpoint."""
    return endpoint.scheme in LISTENING


def announces_here_only(endpoint: Endpoint) -> bool:
    """Return whether only programs on this machine can connect, so that only they shall see it."""
    return is_loopback(endpoint.host)


def read_service(
    service_type: str, name: str, addresses: Sequence[str], port: int | None, txt: Mapping[bytes, bytes | None]
) -> MavlinkService | None:
    """Return a service as announced by anybody; None for one that cannot be connected to.

    `name` is the whole name, e.g. "Rover 1._mavlink._udp.local.". Texts of others are cut and cleaned.
    """
    transport = next((key for key, value in TYPES.items() if value == service_type), None)
    if transport is None or not addresses or not port or not 0 < port < 65536:
        return None
    instance = name.removesuffix(f".{service_type}")
    return MavlinkService(
        name=printable(_text(txt, b"name") or instance)[:MAX_NAME] or "?",
        host=_choose_address(addresses),
        port=port,
        transport=transport,
        system=_system(_text(txt, b"sysid")),
        role=next((role for role in ServiceRole if role.value == _text(txt, b"role")), ServiceRole.UNKNOWN),
    )


def _choose_address(addresses: Sequence[str]) -> str:
    """Return an IPv4 address if there is one: a link-local IPv6 address needs an interface as well."""
    return next((each for each in addresses if ":" not in each), addresses[0])


def _text(txt: Mapping[bytes, bytes | None], key: bytes) -> str:
    return (txt.get(key) or b"").decode("utf-8", "replace")


def _system(text: str) -> int:
    return int(text) if text.isascii() and text.isdigit() and len(text) <= 3 and int(text) <= 255 else 0
