"""Locators of Zenoh, as tls/fleet.example.org:7447?rel=1: protocol, host and port."""

from __future__ import annotations

import msgspec


class Locator(msgspec.Struct, frozen=True):
    """Where a router listens."""

    protocol: str
    host: str
    port: int


def read_locator(text: str) -> Locator | None:
    """Return the parts of a locator; None if it has no port."""
    protocol, _, rest = text.partition("/")
    host, _, port = rest.partition("#")[0].partition("?")[0].rpartition(":")
    if not (port.isascii() and port.isdecimal()) or int(port) > 0xFFFF:
        return None
    return Locator(protocol, host.strip("[]"), int(port))
