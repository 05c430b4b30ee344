"""Announces the vehicle on the local network, where ground stations can then choose it."""

from __future__ import annotations

import logging
import socket
from collections.abc import Sequence
from contextlib import ExitStack

from link.discovery.service import MavlinkService, ServiceRole, can_announce
from link.endpoint import parse_endpoint

log = logging.getLogger(__name__)


def announce(endpoints: Sequence[str], system: int, opened: ExitStack) -> None:
    """Announce the endpoints that listen, until `opened` ends. A failure is logged: the vehicle drives without it."""
    listening = [each for each in map(parse_endpoint, endpoints) if can_announce(each)]
    if not listening:
        log.warning("nothing to announce: no endpoint listens; add one such as udpin:0.0.0.0:14550")
        return
    from link.discovery.mdns import Announcer, DiscoveryError

    service = MavlinkService(
        f"Rover {system} on {socket.gethostname()}", host="", port=0, system=system, role=ServiceRole.VEHICLE
    )
    try:
        opened.callback(Announcer(listening, service).close)
    except DiscoveryError as error:
        log.warning("not announced: %s", error)
