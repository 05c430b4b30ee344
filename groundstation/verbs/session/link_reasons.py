"""Why no vehicle is heard: what each link has received, as the page without a vehicle shows it on the screen."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from groundstation.snapshot import LinkView
from link.core import LinkReport
from link.endpoint import Endpoint, EndpointError, parse_endpoint
from link.protocol.link_events import CONNECTING, link_problem


def describe_silence(links: Sequence[LinkView]) -> str:
    """Return why no vehicle is heard, behind ": "; with several links each is named. "" without links."""
    if len(links) == 1:
        return f": {_reason(links[0])}"
    return "".join(f"{'; ' if at else ': '}{link.name}: {_reason(link)}" for at, link in enumerate(links))


def to_view(report: LinkReport) -> LinkView:
    """Return what the reasons need of a report."""
    return LinkView(
        name=report.name,
        frames=report.frames,
        bytes_received=report.bytes_received,
        dropped=report.dropped,
        systems=tuple(sorted({system for system, _ in report.sources})),
        problem=link_problem(report),
    )


def _reason(link: LinkView) -> str:
    if link.problem:
        waits = link.problem == CONNECTING
        return "the other end does not answer yet" if waits else link.problem.removesuffix("; trying again")
    if link.frames:
        systems = f" from system {', '.join(map(str, link.systems))}" if link.systems else ""
        return f"MAVLink arrives{systems}, but no HEARTBEAT of a vehicle"
    if link.bytes_received:
        return "bytes arrive, but no MAVLink"
    try:
        endpoint = parse_endpoint(link.name)
    except EndpointError:
        return "nothing arrives"
    return _SILENT[endpoint.scheme](endpoint, link.dropped)


def _is_sent_to(endpoint: Endpoint, dropped: int) -> str:
    protocol = endpoint.scheme[:3].upper()
    return f"nothing arrives; a vehicle must send to {protocol} port {endpoint.port} of this computer"


def _asks(endpoint: Endpoint, dropped: int) -> str:
    if dropped and endpoint.scheme == "udpout":
        return "refused: nothing listens there"
    return "no answer; a vehicle must listen there, and no firewall be between"


def _serial(endpoint: Endpoint, dropped: int) -> str:
    return f"nothing arrives; check power, cable (TX to RX) and {endpoint.baud} baud"


def _fleet(endpoint: Endpoint, dropped: int) -> str:
    return "nothing arrives; a vehicle must connect to the same router (docs/fleet.md)"


_SILENT: dict[str, Callable[[Endpoint, int], str]] = {
    "udpin": _is_sent_to,
    "tcpin": _is_sent_to,
    "udpout": _asks,
    "tcpout": _asks,
    "serial": _serial,
    "zenoh": _fleet,
}
"""Scheme of link.endpoint.SCHEMES -> why nothing has arrived, with the number of messages that were refused."""
