"""LinkManager: the shell's part of the Connect screen: links, listening, serial ports and simulators."""

from __future__ import annotations

import logging
import math

from dialects.enums import Severity
from groundstation.connect.discovery import Discovery
from groundstation.connect.listener import VehicleListener
from groundstation.connect.port_scan import PortScan
from groundstation.connect.runtime_links import RuntimeLinks
from groundstation.intents.links import AddLink, CloseLink
from groundstation.intents.session import StartSimulator
from groundstation.sitl.sitl import SimulatorControl, free_port
from groundstation.station.station import Station
from groundstation.station.view_feed import ViewSource
from groundstation.views.connect import ConnectRequest, ConnectView, HeardRow
from link.endpoint import LISTENING, Endpoint, EndpointError, parse_endpoint
from link.protocol.sent_frames import SentFrames
from link.runner import Runner
from link.transport.transport import Link, LinkError

log = logging.getLogger(__name__)

PERIOD = 0.5
"""s between two views."""

LISTEN_FOR = 2.0
"""s after the last view for which the station goes on listening."""


class LinkManager:
    """Handles AddLink, CloseLink and StartSimulator, and builds the view. `ids` are our system and component id."""

    def __init__(
        self,
        runner: Runner,
        station: Station,
        ids: tuple[int, int],
        sent: SentFrames,
        simulators: SimulatorControl | None = None,
    ) -> None:
        """Take over `simulators`, which may run already."""
        self._runner = runner
        self._station = station
        self._runtime_links = RuntimeLinks(runner, station, ids, sent)
        self._listener = VehicleListener(ids)
        self._ports = PortScan()
        self._discovery = Discovery()
        self._simulators = simulators or SimulatorControl()
        self._listen_until = -math.inf
        station.views.add(ConnectRequest, ViewSource(self._build_view, PERIOD))
        station.intents.add_last(
            {AddLink: self._add_link, CloseLink: self._close_link, StartSimulator: self._handle_simulator}
        )

    def _add_link(self, intent: AddLink, now: float) -> None:
        self._release_port(intent.endpoint)
        self._runtime_links.add(intent, now)

    def _close_link(self, intent: CloseLink, now: float) -> None:
        self._runtime_links.close(intent.link, now)

    def _handle_simulator(self, intent: StartSimulator, now: float) -> None:
        if (problem := self._start_simulator(intent.kind)) is not None:
            self._warn(now, problem)

    def tick(self, now: float) -> None:
        """Open and close what is due, and notice the end of a simulator."""
        self._runtime_links.tick(now)
        if now >= self._listen_until:
            self._listener.close()
            self._discovery.pause()
        exited = self._simulators.pop_exit()
        if exited is not None:
            text, output = exited
            self._warn(now, text)
            log.error("output of the simulator:\n%s", output)
        around = self._station.station_info
        around.simulator, around.simulated = self._simulators.state, self._simulators.systems

    def close(self) -> None:
        """Free what was opened, and end the simulators."""
        self._listener.close()
        self._discovery.close()
        self._ports.close()
        self._simulators.close()

    # ---- parts ----

    def _start_simulator(self, kind: str) -> str | None:
        """Start simulators that send to the first of our links that listens, or to a new one; return what failed."""
        if self._simulators.running:
            return None
        if not any(_takes_simulator(link) for link in self._runner.links):
            try:
                self._runtime_links.open_now(f"udpin:127.0.0.1:{free_port()}")
            except LinkError as error:
                return f"simulator did not start: {error}"
        return self._simulators.start([link.endpoint for link in self._runner.links if _takes_simulator(link)], kind)

    def _release_port(self, text: str) -> None:
        """Stop listening where a link shall be opened."""
        try:
            port = parse_endpoint(text).port
        except EndpointError:
            return
        for row in self._listener.listening:
            if parse_endpoint(row.endpoint).port == port:
                self._listener.release(row.endpoint)

    def _warn(self, now: float, text: str) -> None:
        log.warning(text)
        self._station.log.add(now, "station", text, Severity.WARNING)

    # ---- the view ----

    def _build_view(self, request: ConnectRequest, now: float, wall: float) -> ConnectView:
        self._listen_until = now + LISTEN_FOR
        attempts = self._runtime_links.attempts(now)
        coming = [each.endpoint for each in attempts if each.state in ("opening", "failed")]
        ends = [*(link.endpoint for link in self._runner.links), *map(parse_endpoint, coming)]
        self._listener.listen({each.port for each in ends if _is_udpin(each)})
        self._ports.look(now)
        (self._discovery.look if request.search else self._discovery.pause)()
        names = tuple(link.channel.name for link in self._runner.links)
        return ConnectView(
            heard=(*self._open_heard(now), *self._listener.heard(now), *self._discovery.found(frozenset(names))),
            ports=self._ports.rows,
            listening=self._listener.listening,
            attempts=attempts,
            endpoints=names,
            searching=request.search,
            search_problem=self._discovery.problem,
        )

    def _open_heard(self, now: float) -> tuple[HeardRow, ...]:
        """Return the vehicles that are heard over open links."""
        names = {link.channel.index: link.channel.name for link in self._runner.links}
        return tuple(
            HeardRow(
                endpoint=names.get(contact.link, ""),
                system=contact.state.system,
                name=contact.state.name,
                mode=contact.state.mode,
                armed=contact.state.armed,
                silence=round(contact.state.monitor.silence(now), 1),
                driver=contact.state.driver,
                open=True,
            )
            for contact in self._station.fleet
        )


def _is_udpin(endpoint: Endpoint) -> bool:
    return endpoint.scheme in LISTENING and endpoint.scheme.startswith("udp")


def _takes_simulator(link: Link) -> bool:
    return link.endpoint.scheme == "udpin" and not link.watch_only
