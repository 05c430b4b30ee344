"""Self-probe of a router: asks its own ports as a newcomer does, and ends the process when nobody new gets in.

Zenoh (eclipse-zenoh 1.10.2) accepts one connection after the other and pauses for 0.1 s after each that fails in TLS.
Some hundred silent connections of strangers, which fail after 10 s or when they close, keep everybody new out while
they are many; without a free descriptor it does not come back at all. The process lives on with its sessions, so that
no supervisor sees it. One that has ended is started again.
"""

from __future__ import annotations

import contextlib
import resource
import socket
import ssl
import threading
import time
from collections.abc import Callable, Sequence
from pathlib import Path

from link.bridge.fleet.fleet_file import ROUTER, ROUTER_KEY
from link.fleet.locator import read_locator
from link.fleet.probe import ask_quic

PERIOD = 10.0
"""s between two probes."""
TIMEOUT = 5.0
"""s for an answer: a handshake takes 5 ms, and a second on a busy machine."""
TRIES = 3
"""Probes in a row without an answer that end the process. A restart interrupts all who drive, so that what passes in
20 s is waited for."""

_LOOPBACK = {"0.0.0.0": "127.0.0.1", "::": "::1"}
"""Where to ask a listener on all addresses."""


class SelfProbe:
    """The listeners of one router. `ended` is told why nobody gets in, from a thread of its own."""

    def __init__(
        self,
        listen: Sequence[str],
        folder: Path,
        ended: Callable[[str], None],
        *,
        period: float = PERIOD,
        timeout: float = TIMEOUT,
    ) -> None:
        self._listen, self._ended = listen, ended
        self._period, self._timeout = period, timeout
        self._context = _make_context(folder)
        self._closing = threading.Event()
        self._failed = dict.fromkeys(listen, 0)
        """Listener -> probes in a row without an answer."""
        self._thread = threading.Thread(target=self._run, name="self-probe", daemon=True)

    def start(self) -> None:
        """Probe from now on."""
        self._thread.start()

    def close(self) -> None:
        """Stop probing."""
        self._closing.set()

    def check(self) -> str | None:
        """Ask each listener once; return why the process must end, in one line, or None."""
        for locator in self._listen:
            why = self._ask(locator)
            self._failed[locator] = 0 if why is None else self._failed[locator] + 1
            if self._failed[locator] >= TRIES:
                return f"{locator} has not let a newcomer in for {TRIES} probes in {TRIES * PERIOD:.0f} s ({why})"
        return None

    def _run(self) -> None:
        while not self._closing.wait(self._period):
            if (why := self.check()) and not self._closing.is_set():
                self._ended(why)
                return

    def _ask(self, locator: str) -> str | None:
        place = read_locator(locator)
        if place is None:
            return None
        address = _LOOPBACK.get(place.host, place.host), place.port
        try:
            if place.protocol == "quic":
                return None if ask_quic(address, self._timeout) else "no answer"
            if place.protocol == "tls":
                self._shake_hands(address)
        except ssl.SSLError:  # an answer, if an unfriendly one
            return None
        except OSError as error:
            return "no answer" if isinstance(error, TimeoutError) else (error.strerror or str(error)).lower()
        return None

    def _shake_hands(self, address: tuple[str, int]) -> None:
        """Go through the handshake of TLS. Raises OSError, TimeoutError if it takes longer than the timeout."""
        until = time.monotonic() + self._timeout
        with socket.create_connection(address, self._timeout) as plain:
            plain.settimeout(max(0.001, until - time.monotonic()))
            try:
                with self._context.wrap_socket(plain):
                    return
            except ssl.SSLError as error:
                if "timed out" in str(error):
                    raise TimeoutError from None
                raise


def raise_descriptor_limit() -> int:
    """Let this process open as many files and connections as its hard limit allows; return that number."""
    _, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    with contextlib.suppress(OSError, ValueError):  # systems on which the hard limit is only a promise
        resource.setrlimit(resource.RLIMIT_NOFILE, (hard, hard))
    return resource.getrlimit(resource.RLIMIT_NOFILE)[0]


def _make_context(folder: Path) -> ssl.SSLContext:
    """Return a client's side with the router's own certificate: without one each probe would fail, and cost a pause."""
    context = ssl.SSLContext(ssl.PROTOCOL_TLS_CLIENT)
    context.check_hostname, context.verify_mode = False, ssl.CERT_NONE  # it asks whether, not who
    context.load_cert_chain(folder / ROUTER, folder / ROUTER_KEY)
    return context
