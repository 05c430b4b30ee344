"""Endpoints: where a link ends, e.g. "udpin:127.0.0.1:14550".

SCHEMES is the table of all link types: parser, help text and factory. To add a link type, write its module in
link/transport/ and add its row here.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from enum import Enum, auto

import msgspec


class EndpointError(ValueError):
    """An endpoint cannot be parsed; the message is one line with the endpoint, the error and the remedy."""


class Side(Enum):
    """Which end of a link a program is, where both ends write the same endpoint."""

    VEHICLE = auto()
    GROUND_STATION = auto()


class Endpoint(msgspec.Struct, frozen=True):
    """One end of a link, as parsed."""

    text: str
    """As the user wrote it, without `//`."""
    scheme: str
    host: str = ""
    port: int = 0
    """1..65535, for sockets."""
    path: str = ""
    """Of a serial port."""
    baud: int = 0
    """bit/s, for serial ports."""
    locator: str = ""
    """Of a Zenoh router, as "tls/HOST:PORT", or the path of a Zenoh configuration file."""
    fleet: str = ""
    vehicle: str = ""
    """Its name in the fleet; empty for all of them."""
    device: str = ""
    """Network interface to which its sockets are bound, given by the program that trusts it; empty: any."""
    side: Side | None = None
    """Given by the program that opens the endpoint; None: what the endpoint names."""


SERIAL = "serial"
"""The scheme of serial and USB ports."""
ZENOH = "zenoh"
"""The scheme of fleets."""


class Scheme(msgspec.Struct, frozen=True):
    """One link type."""

    syntax: str
    help: str
    parse: Callable[[str, str], Endpoint]
    """Takes the scheme and what follows its colon."""
    factory: str
    """`module:function` of a TransportFactory (link/transport/transport.py), imported when the first one is opened."""
    private: str | None = None
    """`module:function` that takes an endpoint and returns whether strangers cannot send to it; None: its address says
    so (link/transport/reach.py)."""


MIN_BAUD, MAX_BAUD = 300, 12_000_000
"""From old radio modems to the fastest USB adapters; 57600 and 921600 are usual."""

DEFAULT_BAUD = 57600
"""Factory setting of telemetry radios."""

LISTENING = ("udpin", "tcpin")

ANY_ADDRESSES = ("0.0.0.0", "::")
"""Addresses to listen on, and none to send to."""


def is_loopback(host: str) -> bool:
    """Return whether only programs on this machine can reach this host."""
    return host in ("::1", "localhost") or re.fullmatch(r"127(\.[0-9]+){3}", host) is not None


def _parse_host_port(scheme: str, rest: str) -> Endpoint:
    text = f"{scheme}:{rest}"
    host, colon, port = rest.rpartition(":")
    host = host.removeprefix("[").removesuffix("]")
    if not colon or not host:
        raise EndpointError(f"endpoint {text!r}: write {SCHEMES[scheme].syntax}, for example {scheme}:127.0.0.1:14550")
    if not _is_within(port, 1, 65535):
        raise EndpointError(f"endpoint {text!r}: port {port!r} is not a number from 1 to 65535")
    return Endpoint(text, scheme, host, int(port))


def _parse_destination(scheme: str, rest: str) -> Endpoint:
    endpoint = _parse_host_port(scheme, rest)
    if endpoint.host in ANY_ADDRESSES:
        raise EndpointError(
            f"endpoint {endpoint.text!r}: {endpoint.host} is not an address to send to; "
            f"name the other end, or write {scheme[:3]}in:{rest} to wait for it"
        )
    return endpoint


def _is_within(digits: str, low: int, high: int) -> bool:
    """Return whether `digits` is a number from `low` to `high`.

    int() alone would accept other digits than 0 to 9, and raise for thousands of them.
    """
    return digits.isascii() and digits.isdigit() and len(digits) < 20 and low <= int(digits) <= high


def _parse_path_baud(scheme: str, rest: str) -> Endpoint:
    text = f"{scheme}:{rest}"
    path, colon, baud = rest.rpartition(":")  # names under /dev/serial/by-path hold colons, too
    if not colon or not path or not baud:
        raise EndpointError(
            f"endpoint {text!r}: write {SCHEMES[scheme].syntax}, for example {scheme}:/dev/ttyAMA0:57600"
        )
    if not path.startswith("/"):
        raise EndpointError(f"endpoint {text!r}: {path!r} is not an absolute path; write {scheme}:/dev/{path}:{baud}")
    if not _is_within(baud, MIN_BAUD, MAX_BAUD):
        raise EndpointError(f"endpoint {text!r}: baud rate {baud!r} is not a number from {MIN_BAUD} to {MAX_BAUD}")
    return Endpoint(text, scheme, path=path, baud=int(baud))


FLEET_NAME = r"[A-Za-z0-9][A-Za-z0-9._-]{0,23}"
FLEET_NAME_RULE = "1 to 24 letters, digits, dots, hyphens or underscores, beginning with a letter or digit"
_LOCATOR = re.compile(r"(?P<host>(?:tcp|udp|tls|quic)/(?:\[[0-9a-fA-F:]+\]|[^][:/?]+)):(?P<port>[0-9]+)(?:\?[\w=;]+)?")
_CONFIG = re.compile(r"(?P<path>.+?\.json5?)(?:/(?P<names>.*))?")
_ZENOH_EXAMPLE = "for example zenoh:alice.json5/farm or zenoh:tcp/192.168.1.2:7447/farm/rover1"


def _parse_zenoh(scheme: str, rest: str) -> Endpoint:
    text = f"{scheme}:{rest}"
    protocol, _, behind = rest.partition("/")
    if protocol in ("tcp", "udp", "tls", "quic"):
        address, _, names = behind.partition("/")
        locator = f"{protocol}/{address}"
        found = _LOCATOR.fullmatch(locator)
        if not found or not _is_within(found["port"], 1, 65535):
            raise EndpointError(f"endpoint {text!r}: {locator!r} is not an address of a router; {_ZENOH_EXAMPLE}")
    elif config := _CONFIG.fullmatch(rest):
        locator, names = config["path"], config["names"] or ""
    else:
        raise EndpointError(f"endpoint {text!r}: write {SCHEMES[scheme].syntax}, {_ZENOH_EXAMPLE}")
    fleet, *vehicle = names.split("/")
    if not fleet or len(vehicle) > 1:
        raise EndpointError(f"endpoint {text!r}: name the fleet behind {locator}, and one vehicle at most")
    for name in (fleet, *vehicle):
        if not re.fullmatch(FLEET_NAME, name):
            raise EndpointError(f"endpoint {text!r}: {name!r} is not a name; it has {FLEET_NAME_RULE}")
    return Endpoint(text, scheme, locator=locator, fleet=fleet, vehicle="".join(vehicle))


SCHEMES: dict[str, Scheme] = {
    "udpin": Scheme(
        "udpin:HOST:PORT",
        "listen on this address; answer every peer that sends a heartbeat",
        _parse_host_port,
        "link.transport.udp:open_udp",
    ),
    "udpout": Scheme(
        "udpout:HOST:PORT", "send to this address first", _parse_destination, "link.transport.udp:open_udp"
    ),
    "tcpin": Scheme(
        "tcpin:HOST:PORT", "listen on this address for connections", _parse_host_port, "link.transport.tcp:open_tcpin"
    ),
    "tcpout": Scheme(
        "tcpout:HOST:PORT",
        "connect to this address; reconnect when the connection ends",
        _parse_destination,
        "link.transport.tcp:open_tcpout",
    ),
    SERIAL: Scheme(
        "serial:PATH:BAUD",
        "serial port or USB radio; reopened after it was unplugged",
        _parse_path_baud,
        "link.transport.serial:open_serial",
    ),
    ZENOH: Scheme(
        "zenoh:FILE_OR_ROUTER/FLEET[/VEHICLE]",
        "over a router on the internet, see docs/fleet.md; FILE.json5 is made by `mavhelm bridge fleet`",
        _parse_zenoh,
        "link.fleet.transport:open_fleet",
        private="link.fleet.config:is_private",
    ),
}
"""Scheme -> its link type."""

SCHEME_ALIASES = {"tcp": "tcpout", "udp": "udpin"}
"""MAVProxy's and pymavlink's names -> ours."""


def parse_endpoint(text: str) -> Endpoint:
    """Parse one endpoint; `udpin://HOST:PORT` is the same as `udpin:HOST:PORT`. Raises EndpointError."""
    scheme, colon, rest = text.strip().partition(":")
    scheme = scheme.lower()
    if scheme not in SCHEMES or not colon:
        raise EndpointError(
            f"endpoint {text!r}: {_hint(text.strip(), scheme)}it must be one of "
            + ", ".join(each.syntax for each in SCHEMES.values())
        )
    return SCHEMES[scheme].parse(scheme, rest.removeprefix("//").rstrip("/"))


def parse_endpoints(texts: Sequence[str]) -> list[Endpoint]:
    """Parse all endpoints. Raises EndpointError, also for two that are the same or listen on the same port."""
    endpoints = [parse_endpoint(text) for text in texts]
    for number, endpoint in enumerate(endpoints):
        for before in endpoints[:number]:
            if _end(endpoint) == _end(before):
                raise EndpointError(f"endpoint {endpoint.text!r} is given twice")
            if _listens_for_both(endpoint, before) or _listens_for_both(before, endpoint):
                raise EndpointError(
                    f"endpoints {before.text!r} and {endpoint.text!r} listen on the same port; leave one of them out"
                )
    return endpoints


def _end(endpoint: Endpoint) -> tuple[str | int, ...]:
    host = "127.0.0.1" if endpoint.host == "localhost" else endpoint.host
    names = (endpoint.locator, endpoint.fleet, endpoint.vehicle)
    return endpoint.scheme, host, endpoint.port, endpoint.path, *names


def _listens_for_both(one: Endpoint, other: Endpoint) -> bool:
    """Return whether `one` listens on all addresses, so that `other` finds its port taken."""
    listens = one.scheme in LISTENING and one.host in ANY_ADDRESSES
    return listens and (one.scheme, one.port) == (other.scheme, other.port)


def _hint(text: str, scheme: str) -> str:
    """Return "did you mean ...? " for a typing error or MAVProxy's syntax, or an empty text."""
    if text.startswith("/dev/"):
        path, _, baud = text.replace(",", ":").rpartition(":")
        path, baud = (path, baud) if path and baud.isdigit() else (text, str(DEFAULT_BAUD))
        return f"did you mean serial:{path}:{baud}? "
    import difflib  # when it is needed: it takes 1 ms of each start

    if scheme == "udpbcast":
        return "broadcasts are not sent: name one machine with udpout:HOST:PORT, or listen with udpin; "
    near = difflib.get_close_matches(scheme, SCHEMES, n=1, cutoff=0.6)
    if scheme in SCHEME_ALIASES or near:
        return f"did you mean {SCHEME_ALIASES.get(scheme) or near[0]}:{text.partition(':')[2].removeprefix('//')}? "
    address = re.fullmatch(r"(localhost|[\w-]+(?:\.[\w-]+)+|\[[0-9a-fA-F:]+\]):[0-9]+", text)
    if not address:
        return ""
    host = address[1].strip("[]")
    listen = is_loopback(host) or host in ANY_ADDRESSES
    return f"did you mean {'udpin' if listen else 'udpout'}:{text}? "


def endpoint_help() -> str:
    """Return the table of link types as lines for --help."""
    width = max(len(each.syntax) for each in SCHEMES.values())
    return "\n".join(f"  {each.syntax:<{width}}  {each.help}" for each in SCHEMES.values())
