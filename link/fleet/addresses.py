"""The addresses of a router. Names are looked up in a thread, because a name server out of reach takes long to fail."""

from __future__ import annotations

import contextlib
import socket
import threading
import time

LOOK_AGAIN = 5.0
"""s from the begin of one lookup to the next one."""
FIRST_ANSWER = 0.25
"""s that the first lookup is waited for at a time."""

AddressInfo = tuple[int, int, int, str, "socket._Address"]
"""Family, kind, protocol, name, address: a row of socket.getaddrinfo."""


class Addresses:
    """Of one host. find() is called from one thread."""

    def __init__(self, host: str, port: int, kind: socket.SocketKind) -> None:
        self.problem: str | None = None
        """Why the newest lookup failed, if none before has succeeded."""
        self._host, self._port, self._kind = host, port, kind
        self._found: list[AddressInfo] = []
        """Of the newest lookup that succeeded."""
        self._lookup: threading.Thread | None = None
        self._due = 0.0
        with contextlib.suppress(OSError, UnicodeError):
            self._found, self._due = self._ask(socket.AI_NUMERICHOST), float("inf")

    def find(self) -> list[AddressInfo]:
        """Return what is known, and look again if that is due."""
        if time.monotonic() >= self._due and (self._lookup is None or not self._lookup.is_alive()):
            self._due = time.monotonic() + LOOK_AGAIN
            self._lookup = threading.Thread(target=self._look, name="fleet lookup", daemon=True)
            self._lookup.start()
        if self._lookup is not None and not self._found:
            self._lookup.join(FIRST_ANSWER)
        return self._found

    def _look(self) -> None:
        try:
            self._found, self.problem = self._ask(0), None
        except (OSError, UnicodeError):
            if not self._found:
                self.problem = f"host {self._host!r} is not known; check the name or the network"

    def _ask(self, flags: int) -> list[AddressInfo]:
        return list(socket.getaddrinfo(self._host, self._port, type=self._kind, flags=flags))
