"""What to try while no vehicle is found: what each link has received, and commands that work as printed."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from enum import Enum, auto

import msgspec

from groundstation.snapshot import LinkView, Snapshot
from link.endpoint import ANY_ADDRESSES, Endpoint, EndpointError, is_loopback, parse_endpoint

MAX_ADDRESSES = 2
"""Addresses of this machine for which a command is printed; the first is that of the default route."""

MAX_SYSTEMS = 5
"""System ids that are named; bytes of another protocol may look like frames of many."""


class AdviceKind(Enum):
    """How a line is drawn."""

    TEXT = auto()
    COMMAND = auto()
    """To be typed as it is."""
    WARNING = auto()


class WaitingAdvice(msgspec.Struct, frozen=True):
    """One line."""

    kind: AdviceKind
    text: str


def describe_link(link: LinkView) -> WaitingAdvice:
    """Return what a link has received so far, and what is wrong with that."""
    if not link.bytes_received:
        if link.dropped and link.name.startswith("udpout:"):
            return _warning(f"{link.name}: 0 bytes received, {link.dropped} refused: nothing listens there")
        return _text(f"{link.name}: 0 bytes received")
    bad = f", {link.crc_errors} bad checksums" if link.crc_errors else ""
    if not link.frames:
        return _warning(f"{link.name}: {link.bytes_received} bytes received, no MAVLink frame{bad}")
    more = " ..." if len(link.systems) > MAX_SYSTEMS else ""
    heard = f" from system {', '.join(map(str, link.systems[:MAX_SYSTEMS]))}{more}" if link.systems else ""
    return _warning(f"{link.name}: {link.frames} frames received{heard}, no HEARTBEAT of a vehicle{bad}")


def advise(snapshot: Snapshot, quit_key: str) -> list[WaitingAdvice]:
    """Return what to try, link after link; `quit_key` as it is printed."""
    lines: list[WaitingAdvice] = []
    for text in snapshot.endpoints:
        try:
            endpoint = parse_endpoint(text)
        except EndpointError:
            continue
        if endpoint.scheme in _BY_SCHEME:
            lines += _BY_SCHEME[endpoint.scheme](endpoint, snapshot.addresses, quit_key)
    return lines


def _listening(endpoint: Endpoint, addresses: Sequence[str], quit_key: str) -> Iterator[WaitingAdvice]:
    """For udpin and tcpin: who can send here, and how."""
    kind = "udpout" if endpoint.scheme == "udpin" else "tcpout"
    if is_loopback(endpoint.host):
        yield _text(f"Only programs on this machine can reach {endpoint.host}. In another terminal:")
        yield _command(f"mavhelm vehicle --sim {kind}:{_bracketed(endpoint.host)}:{endpoint.port}")
        yield _text(f"For vehicles on other machines, quit ({quit_key}) and start:")
        yield _command(f"mavhelm {endpoint.scheme}:0.0.0.0:{endpoint.port}")
        return
    reachable = [*addresses[:MAX_ADDRESSES]] if endpoint.host in ANY_ADDRESSES else [endpoint.host]
    if not reachable:
        yield _warning("This machine has no network address yet: connect it to the network of the vehicle.")
        return
    yield _text("On the computer of the vehicle, start the mavhelm daemon:")
    for host in reachable:
        yield _command(f"mavhelm vehicle --config rover.toml {kind}:{_bracketed(host)}:{endpoint.port}")
    yield _text("To try the link without a rover, simulate one, there or here:")
    yield _command(f"mavhelm vehicle --sim {kind}:{_bracketed(reachable[0])}:{endpoint.port}")
    protocol = kind[:3].upper()
    yield _text(f"Other autopilots: send to {reachable[0]}, {protocol} port {endpoint.port}; firewalls must let it in.")


def _sending(endpoint: Endpoint, addresses: Sequence[str], quit_key: str) -> Iterator[WaitingAdvice]:
    """For udpout and tcpout: what must listen at the other end."""
    kind = "udpin" if endpoint.scheme == "udpout" else "tcpin"
    if is_loopback(endpoint.host):
        yield _text(f"A vehicle on this machine must listen on port {endpoint.port}. In another terminal:")
        yield _command(f"mavhelm vehicle --sim {kind}:{_bracketed(endpoint.host)}:{endpoint.port}")
        return
    yield _text(f"A vehicle must listen at {endpoint.host}, port {endpoint.port}. There, start the mavhelm daemon:")
    yield _command(f"mavhelm vehicle --config rover.toml {kind}:0.0.0.0:{endpoint.port}")


def _serial(endpoint: Endpoint, addresses: Sequence[str], quit_key: str) -> Iterator[WaitingAdvice]:
    """For a serial port: what is wrong most often."""
    yield _text("Check that the vehicle and both radios have power, and at the cable:")
    yield _text("  TX goes to RX and RX to TX, and the grounds are connected")
    yield _text(f"  both ends use {endpoint.baud} baud; radios usually 57600, USB ports 115200")
    yield _text("  the autopilot sends MAVLink on that port (ArduPilot: SERIALn_PROTOCOL 2)")


def _fleet(endpoint: Endpoint, addresses: Sequence[str], quit_key: str) -> Iterator[WaitingAdvice]:
    """For a router: what the vehicle starts, with a file of its own."""
    vehicle = endpoint.vehicle or "rover1"
    is_file = ".json" in endpoint.locator
    place = f"{vehicle}.json5" if is_file else endpoint.locator
    yield _text(f"A vehicle must connect to the same router{', with its own file' if is_file else ''}. There:")
    yield _command(f"mavhelm vehicle --config rover.toml zenoh:{place}/{endpoint.fleet}/{vehicle}")
    yield _text("docs/fleet.md tells how its file is made, and what the router says of those who connect.")


def _text(text: str) -> WaitingAdvice:
    return WaitingAdvice(AdviceKind.TEXT, text)


def _command(text: str) -> WaitingAdvice:
    return WaitingAdvice(AdviceKind.COMMAND, text)


def _warning(text: str) -> WaitingAdvice:
    return WaitingAdvice(AdviceKind.WARNING, text)


def _bracketed(host: str) -> str:
    return f"[{host}]" if ":" in host else host


_BY_SCHEME: dict[str, Callable[[Endpoint, Sequence[str], str], Iterator[WaitingAdvice]]] = {
    "udpin": _listening,
    "tcpin": _listening,
    "udpout": _sending,
    "tcpout": _sending,
    "serial": _serial,
    "zenoh": _fleet,
}
"""Scheme of link.endpoint.SCHEMES -> its advice."""
