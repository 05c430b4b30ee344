"""Where a link ends: "udpin:127.0.0.1:14550" and its kind. ONE table is the parser and the help text."""

from __future__ import annotations

import difflib
from collections.abc import Callable
from dataclasses import dataclass


class EndpointError(ValueError):
    """The text of an endpoint is wrong; the message is one line that says what, where and what to do."""


@dataclass(frozen=True, slots=True)
class Endpoint:
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


@dataclass(frozen=True, slots=True)
class Scheme:
    """A kind of endpoint: how it looks, what it does, how its text is read."""

    form: str
    help: str
    parse: Callable[[str, str], Endpoint]


def _host_port(scheme: str, rest: str) -> Endpoint:
    text = f"{scheme}:{rest}"
    host, colon, port = rest.rpartition(":")
    host = host.removeprefix("[").removesuffix("]")
    if not colon or not host:
        raise EndpointError(f"endpoint {text!r}: write {SCHEMES[scheme].form}, for example {scheme}:127.0.0.1:14550")
    if not _within(port, 1, 65535):
        raise EndpointError(f"endpoint {text!r}: port {port!r} is not a number from 1 to 65535")
    return Endpoint(text, scheme, host, int(port))


def _within(digits: str, low: int, high: int) -> bool:
    """Python's int takes other digits than 0 to 9 too, and raises for some thousands of them."""
    return digits.isascii() and digits.isdigit() and len(digits) < 20 and low <= int(digits) <= high


def _path_baud(scheme: str, rest: str) -> Endpoint:
    text = f"{scheme}:{rest}"
    path, colon, baud = rest.rpartition(":")  # names under /dev/serial/by-path hold colons, too
    if not colon or not path or not baud:
        raise EndpointError(f"endpoint {text!r}: write {SCHEMES[scheme].form}, for example {scheme}:/dev/ttyAMA0:57600")
    if not path.startswith("/"):
        raise EndpointError(f"endpoint {text!r}: {path!r} is no path; write {scheme}:/dev/{path}:{baud}")
    if not _within(baud, MIN_BAUD, MAX_BAUD):
        raise EndpointError(f"endpoint {text!r}: baud rate {baud!r} is not a number from {MIN_BAUD} to {MAX_BAUD}")
    return Endpoint(text, scheme, path=path, baud=int(baud))


MIN_BAUD, MAX_BAUD = 300, 12_000_000
"""What a radio modem of old and the fastest USB adapters take; 57600 and 921600 are usual."""

DEFAULT_BAUD = 57600
"""What telemetry radios have at first."""
SCHEME_ALIASES = {"tcp": "tcpout", "udp": "udpin", "udpbcast": "udpout"}
"""MAVProxy's and pymavlink's names -> ours."""

SCHEMES: dict[str, Scheme] = {
    "udpin": Scheme("udpin:HOST:PORT", "wait on this address; answer whoever shows a heartbeat", _host_port),
    "udpout": Scheme("udpout:HOST:PORT", "send to this address first", _host_port),
    "tcpin": Scheme("tcpin:HOST:PORT", "wait on this address for connections", _host_port),
    "tcpout": Scheme("tcpout:HOST:PORT", "connect to this address, again and again", _host_port),
    "serial": Scheme("serial:PATH:BAUD", "serial port or USB radio; unplugged, it is waited for", _path_baud),
}
"""Scheme -> its parser and help. link/transport/transports.py holds what opens each."""


def parse_endpoint(text: str) -> Endpoint:
    """The endpoint that `text` names; `udpin://HOST:PORT` is the same as `udpin:HOST:PORT`. Raises EndpointError."""
    scheme, colon, rest = text.strip().partition(":")
    scheme = scheme.lower()
    if scheme not in SCHEMES or not colon:
        raise EndpointError(
            f"endpoint {text!r}: {_hint(text.strip(), scheme)}it must be one of "
            + ", ".join(each.form for each in SCHEMES.values())
        )
    return SCHEMES[scheme].parse(scheme, rest.removeprefix("//").rstrip("/"))


def _hint(text: str, scheme: str) -> str:
    """What was meant, where that can be told: a slip of the pen, or how MAVProxy writes it."""
    if text.startswith("/dev/"):
        path, _, baud = text.replace(",", ":").rpartition(":")
        path, baud = (path, baud) if path and baud.isdigit() else (text, str(DEFAULT_BAUD))
        return f"did you mean serial:{path}:{baud}? "
    near = (
        [SCHEME_ALIASES[scheme]]
        if scheme in SCHEME_ALIASES
        else difflib.get_close_matches(scheme, SCHEMES, n=1, cutoff=0.6)
    )
    return f"did you mean {near[0]}:? " if near else ""


def endpoint_help() -> str:
    """The table as lines for --help."""
    width = max(len(each.form) for each in SCHEMES.values())
    return "\n".join(f"  {each.form:<{width}}  {each.help}" for each in SCHEMES.values())
