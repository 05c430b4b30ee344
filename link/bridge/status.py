"""The bridge's status, once a second: links and routes, with rates of the last second and totals."""

from __future__ import annotations

from collections.abc import Hashable, Sequence
from typing import Any

import msgspec

from link.protocol.frame import noise_hint
from link.routing.route_report import RouteReport, TransportReport
from link.routing.router import Router
from link.transport.transport import Transport


class LinkStatus(msgspec.Struct, frozen=True):
    """One link. Rates are those of the last second; `loss` is 0..1; counts are since the start."""

    endpoint: str
    problem: str | None
    peers: int
    frames_in_per_s: float
    bytes_in_per_s: float
    frames_out_per_s: float
    bytes_out_per_s: float
    loss: float
    """Share of frames lost in the last second, by their sequence numbers."""
    lost: int
    crc_errors: int
    noise_bytes: int
    unknown: int
    """Frames with an id outside the dialect, which are forwarded as well."""
    dropped: int
    """Frames dropped because this link had no room."""


class RouteStatus(msgspec.Struct, frozen=True):
    """One system and component, and the peer behind which it was seen."""

    system: int
    component: int
    endpoint: str
    address: str
    silence: float
    """s since the last frame from there."""
    frames_per_s: float
    lost: int


class BridgeStatus(msgspec.Struct, frozen=True):
    """The whole status."""

    links: tuple[LinkStatus, ...]
    routes: tuple[RouteStatus, ...]
    duplicates: int
    """Repeats that redundant links brought."""
    refused_peers: int
    recorder_problem: str | None = None

    def to_dict(self) -> dict[str, Any]:
        """Return the status for JSON."""
        status: dict[str, Any] = msgspec.to_builtins(self)
        return status


class StatusMeter:
    """Computes rates from two readings."""

    def __init__(self, transports: Sequence[Transport], router: Router) -> None:
        self._transports = transports
        self._router = router
        self._reports = router.table.transport_reports()
        self._received: dict[tuple[int, int, int, Hashable], int] = {}
        self._at: float | None = None

    def read(self, now: float, recorder_problem: str | None = None) -> BridgeStatus:
        """Return the status, with the rates since the last reading."""
        period = now - self._at if self._at is not None and now > self._at else 1.0
        reports, before = self._router.table.transport_reports(), self._reports
        routes = self._router.table.route_reports(now)
        status = BridgeStatus(
            links=tuple(
                _link(transport, report, past, period)
                for transport, report, past in zip(self._transports, reports, before, strict=True)
            ),
            routes=tuple(self._route(route, period) for route in routes),
            duplicates=self._router.duplicates,
            refused_peers=self._router.table.refused_peers,
            recorder_problem=recorder_problem,
        )
        self._at, self._reports = now, reports
        self._received = {_key(route): route.received for route in routes}
        return status

    def _route(self, route: RouteReport, period: float) -> RouteStatus:
        return RouteStatus(
            system=route.system,
            component=route.component,
            endpoint=self._transports[route.link].endpoint.text,
            address=address_text(route.address),
            silence=round(route.silence, 3),
            frames_per_s=round((route.received - self._received.get(_key(route), 0)) / period, 1),
            lost=route.lost,
        )


def address_text(address: Hashable) -> str:
    """Return `HOST:PORT` of a socket's address, or a fixed address as it is."""
    if isinstance(address, tuple) and len(address) >= 2:
        return f"{address[0]}:{address[1]}"
    return str(address)


def _key(route: RouteReport) -> tuple[int, int, int, Hashable]:
    return route.system, route.component, route.link, route.address


def _link(transport: Transport, report: TransportReport, past: TransportReport, period: float) -> LinkStatus:
    name = transport.endpoint.text
    hint = noise_hint(name, report.bytes_in, report.frames_in) if transport.capacity is not None else None
    received, lost = report.received - past.received, report.lost - past.lost
    return LinkStatus(
        endpoint=name,
        problem=transport.problem or hint,
        peers=report.peers,
        frames_in_per_s=round((report.frames_in - past.frames_in) / period, 1),
        bytes_in_per_s=round((report.bytes_in - past.bytes_in) / period, 1),
        frames_out_per_s=round((report.frames_out - past.frames_out) / period, 1),
        bytes_out_per_s=round((report.bytes_out - past.bytes_out) / period, 1),
        loss=round(max(0, lost) / (received + lost), 4) if received > 0 and lost > 0 else 0.0,
        lost=report.lost,
        crc_errors=report.crc_errors,
        noise_bytes=report.noise_bytes,
        unknown=report.unknown,
        dropped=transport.dropped,
    )
