"""Opens transports: finds the factory of each endpoint in link.endpoint.SCHEMES."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from importlib import import_module

from msgspec.structs import replace

from link.endpoint import SCHEMES, Scheme, Side, parse_endpoints
from link.transport.transport import LinkError, Transport, TransportFactory


def load_factory(scheme: Scheme) -> TransportFactory:
    """Import the factory of a link type."""
    module, _, name = scheme.factory.partition(":")
    factory: TransportFactory = getattr(import_module(module), name)
    return factory


def open_transports(
    endpoints: Sequence[str], side: Side | None = None, devices: Mapping[str, str] | None = None
) -> list[Transport]:
    """Open all endpoints, or none. Raises EndpointError or LinkError.

    `side`: which end this program is. `devices`: endpoint -> network interface, for those bound to one.
    """
    transports: list[Transport] = []
    try:
        parsed = [
            replace(each, side=side, device=(devices or {}).get(text, ""))
            for text, each in zip(endpoints, parse_endpoints(endpoints), strict=True)
        ]
        transports.extend(load_factory(SCHEMES[each.scheme])(each) for each in parsed)
    except LinkError:
        for transport in transports:
            transport.close()
        raise
    return transports
