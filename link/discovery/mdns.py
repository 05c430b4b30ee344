"""Announcer and Browser: multicast DNS by the library zeroconf (extra [discovery]), which has threads of its own."""

from __future__ import annotations

import logging
import socket
import threading
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from typing import TYPE_CHECKING

from link.discovery.service import TYPES, MavlinkService, announces_here_only, can_announce, read_service
from link.endpoint import ANY_ADDRESSES, Endpoint
from link.runtime.install_hint import install_command
from link.transport.local_addresses import LocalAddresses

if TYPE_CHECKING:
    import zeroconf

log = logging.getLogger(__name__)

LOOPBACK = "127.0.0.1"

MAX_SERVICES = 256
"""Services that are listed: a network may be full of them."""

ANSWER_TIMEOUT = 1500
"""ms for the address of a service that was named."""


def _missing() -> str:
    return f"discovery on the network needs the package zeroconf: {install_command('discovery')}"


class DiscoveryError(Exception):
    """Multicast DNS is not to be had; the message is one line."""


class Announcer:
    """Announces listening endpoints until it is closed. Raises DiscoveryError."""

    def __init__(self, endpoints: Sequence[Endpoint], service: MavlinkService) -> None:
        """`service` says who we are; host, port and transport come from each endpoint.

        What only this machine can reach is announced on the loopback interface only.
        """
        self._responders = [
            _Responder(each, service) for each in endpoints if can_announce(each) and not _is_ipv6(each.host)
        ]

    @property
    def count(self) -> int:
        """Number of endpoints that are announced."""
        return len(self._responders)

    def close(self) -> None:
        """Withdraw the announcements."""
        for each in self._responders:
            each.close()


class _Responder:
    """Announces one endpoint, on the interfaces that reach it."""

    def __init__(self, endpoint: Endpoint, service: MavlinkService) -> None:
        try:
            import zeroconf
        except ImportError:
            raise DiscoveryError(_missing()) from None
        transport = endpoint.scheme.removesuffix("in")
        addresses = _addresses(endpoint)
        interfaces = zeroconf.InterfaceChoice.All if endpoint.host in ANY_ADDRESSES else addresses
        info = zeroconf.ServiceInfo(
            TYPES[transport],
            f"{service.name.replace('.', ' ')} {endpoint.port}.{TYPES[transport]}",
            addresses=[socket.inet_aton(each) for each in addresses],
            port=endpoint.port,
            properties=service.txt,
            server=f"mavhelm-{service.role.value}-{service.system}-{endpoint.port}.local.",
        )
        try:
            with ThreadPoolExecutor(1) as thread:  # in one with an event loop the library would use that loop
                self._zeroconf = thread.submit(zeroconf.Zeroconf, interfaces=interfaces).result()
        except OSError as error:
            raise DiscoveryError(f"{endpoint.text} is not announced: {error.strerror}") from error
        # It takes 1.7 s: the name is tested first, so that no two ends have the same.
        threading.Thread(target=self._register, args=(info,), daemon=True).start()

    def _register(self, info: zeroconf.ServiceInfo) -> None:
        try:
            self._zeroconf.register_service(info, allow_name_change=True)
        except Exception as error:  # the library raises classes of its own, EventLoopBlocked and others
            log.warning("the announcement on the network failed: %s", error)

    def close(self) -> None:
        self._zeroconf.close()


class Browser:
    """Lists the services of the network while it is open. Opening and closing block for a moment: use a thread."""

    def __init__(self) -> None:
        self.problem = ""
        """Why nothing is found, one line."""
        self._found: dict[str, MavlinkService] = {}
        self._zeroconf: zeroconf.Zeroconf | None = None

    @property
    def services(self) -> tuple[MavlinkService, ...]:
        """What is announced now, in the order of names. May be read from any thread."""
        return tuple(sorted(self._found.copy().values(), key=lambda each: (each.name, each.endpoint)))

    def open(self) -> None:
        """Begin to listen and to ask. Errors are in `problem`."""
        if self._zeroconf is not None:
            return
        try:
            import zeroconf

            self._zeroconf = zeroconf.Zeroconf(interfaces=zeroconf.InterfaceChoice.All)
            zeroconf.ServiceBrowser(self._zeroconf, list(TYPES.values()), self)  # type: ignore[arg-type]
            self.problem = ""
        except ImportError:
            self.problem = _missing()
        except OSError as error:
            self.problem = f"discovery on the network: {error.strerror}"

    def close(self) -> None:
        """Stop listening and forget what was found."""
        opened, self._zeroconf = self._zeroconf, None
        if opened is not None:
            opened.close()
        self._found.clear()

    # ---- called by the library, in its own thread ----

    def add_service(self, opened: zeroconf.Zeroconf, kind: str, name: str) -> None:
        """Resolve a service that was announced."""
        info = opened.get_service_info(kind, name, timeout=ANSWER_TIMEOUT)
        if info is None or len(self._found) >= MAX_SERVICES:
            return
        service = read_service(kind, name, info.parsed_addresses(), info.port, info.properties)
        if service is not None and self._zeroconf is opened:
            self._found[name] = service

    def update_service(self, opened: zeroconf.Zeroconf, kind: str, name: str) -> None:
        """Resolve it again: its address or its text has changed."""
        self.add_service(opened, kind, name)

    def remove_service(self, opened: zeroconf.Zeroconf, kind: str, name: str) -> None:
        """Forget it: it has said goodbye, or its announcement has expired."""
        self._found.pop(name, None)


def _addresses(endpoint: Endpoint) -> list[str]:
    """Return the addresses at which others reach an endpoint of this machine."""
    if announces_here_only(endpoint):
        return [LOOPBACK]
    if endpoint.host in ANY_ADDRESSES:
        return [*LocalAddresses().find(0.0)] or [LOOPBACK]
    return [endpoint.host]


def _is_ipv6(host: str) -> bool:
    return ":" in host and host not in ANY_ADDRESSES
