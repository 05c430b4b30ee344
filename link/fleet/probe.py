"""Finds a router that can be reached: one small packet to each, again and again, until one answers.

Zenoh alone needs up to 2 s to see that a network is back: the kernel repeats the first packet of a connection after
1 s only, and the next attempt waits until the one before has failed. A probe is the first packet of a new TCP
connection, or of QUIC a packet of a version that does not exist, which every server answers (RFC 9000, 6.1). The
router's process sees neither: it would take a connection without TLS as an error, and pause for 0.1 s.
"""

from __future__ import annotations

import contextlib
import os
import random
import selectors
import socket
import struct
import threading
import time
from collections.abc import Callable, Sequence

from link.fleet.addresses import Addresses
from link.fleet.locator import Locator, read_locator

PERIOD = 0.2
"""s between two probes of a router, with a deviation of up to JITTER: after an outage all vehicles ask it at once."""
JITTER = 0.05
LIFE = 1.0
"""s that a probe waits for its answer: then the kernel would repeat its packet."""
OTHERS_FIRST = 1.0
"""s in which another router is preferred to the one tried last: it may accept connections and do nothing."""
MOST_ADDRESSES = 4
"""Addresses of one host that are asked."""
_STREAMS, _QUIC = ("tcp", "tls", "ws"), "quic"
_NO_VERSION = bytes.fromhex("1a2a3a4a")
"""Reserved to make a server name the versions that it knows (RFC 9000, 15)."""
_QUIC_SIZE = 1200
"""Bytes; a server answers no shorter packet."""

Tell = Callable[[str], None]


class RouterProbe:
    """The routers of one program. find() is called from one thread."""

    def __init__(self, locators: Sequence[str]) -> None:
        self._targets = [_Target(each) for each in locators]
        self._told = ""

    def find(self, tried: str | None, closing: threading.Event, tell: Tell) -> str | None:
        """Return the locator of a router that answers; None once `closing` is set.

        `tried` was in use or tried last. `tell` gets why the first router does not answer, whenever that changes.
        """
        self._told, begun = "", time.monotonic()
        with selectors.DefaultSelector() as selector, contextlib.ExitStack() as stack:
            for target in self._targets:
                stack.callback(target.end, selector)
            while not closing.is_set():
                patient = time.monotonic() - begun < OTHERS_FIRST
                asked = [each for each in self._targets if each.locator != tried or not patient] or self._targets
                for target in asked:
                    target.ask(selector)
                if found := self._listen(selector, asked):
                    return found
                self._report(tell)
        return None

    def _listen(self, selector: selectors.BaseSelector, asked: Sequence[_Target]) -> str | None:
        """Wait for answers until the next probes are due; return the router that has answered."""
        until = time.monotonic() + random.uniform(PERIOD - JITTER, PERIOD + JITTER)
        if blind := next((each for each in asked if each.is_blind), None):
            return blind.locator
        while (left := until - time.monotonic()) > 0:
            for key, _ in selector.select(left):
                target: _Target = key.data
                if target.read(selector, key.fileobj):  # type: ignore[arg-type]
                    return target.locator
        return None

    def _report(self, tell: Tell) -> None:
        problem = self._targets[0].problem
        if problem and problem != self._told:
            self._told = problem
            tell(problem)


class _Target:
    """One router, and its probes that wait for an answer."""

    def __init__(self, locator: str) -> None:
        self.locator = locator
        self.problem: str | None = None
        """Why it does not answer; None before that is known."""
        self._place: Locator | None = read_locator(locator)
        self.is_blind = self._place is None or self._place.protocol not in (*_STREAMS, _QUIC)
        """Nothing but Zenoh itself can ask this router."""
        kind = socket.SOCK_DGRAM if self._place and self._place.protocol == _QUIC else socket.SOCK_STREAM
        self._addresses = None if self._place is None else Addresses(self._place.host, self._place.port, kind)
        self._sent: dict[socket.socket, float] = {}
        """Probe -> when it was sent."""

    def ask(self, selector: selectors.BaseSelector) -> None:
        """Send a probe to each address; give up those that are too old."""
        now = time.monotonic()
        for old in [each for each, at in self._sent.items() if now - at >= LIFE]:
            self._drop(selector, old, "no answer")
        if self._addresses is None or self.is_blind:
            return
        for family, kind, protocol, _, address in self._addresses.find()[:MOST_ADDRESSES]:
            try:
                probe = socket.socket(family, kind, protocol)
            except OSError as error:  # no descriptor left, or no IPv6
                self._fail(error.strerror or str(error))
                continue
            self._sent[probe] = now
            self._send(selector, probe, address)
        self.problem = self._addresses.problem or self.problem

    def read(self, selector: selectors.BaseSelector, probe: socket.socket) -> bool:
        """Return whether a probe was answered by a router that listens."""
        try:
            if probe.type == socket.SOCK_DGRAM:
                return _is_version_list(probe.recv(2048))
            if error := probe.getsockopt(socket.SOL_SOCKET, socket.SO_ERROR):
                raise OSError(error, os.strerror(error))
        except OSError as error:
            self._drop(selector, probe, error.strerror or str(error))
            return False
        return True

    def end(self, selector: selectors.BaseSelector) -> None:
        """Give up all probes."""
        for each in list(self._sent):
            self._drop(selector, each, None)
        self.problem = None

    def _send(self, selector: selectors.BaseSelector, probe: socket.socket, address: socket._Address) -> None:
        probe.setblocking(False)
        is_quic = probe.type == socket.SOCK_DGRAM
        if not is_quic:
            _leave_half_open(probe)
        selector.register(probe, selectors.EVENT_READ if is_quic else selectors.EVENT_WRITE, self)
        try:
            probe.connect(address)
            if is_quic:
                probe.send(_quic_packet())
        except BlockingIOError:
            pass
        except OSError as error:
            self._drop(selector, probe, error.strerror or str(error))

    def _drop(self, selector: selectors.BaseSelector, probe: socket.socket, why: str | None) -> None:
        del self._sent[probe]
        selector.unregister(probe)
        probe.close()
        if why:
            self._fail(why)

    def _fail(self, why: str) -> None:
        self.problem = f"no router at {self.locator} ({why.lower()})"


def ask_quic(address: tuple[str, int], timeout: float) -> bool:
    """Return whether a QUIC server answers within `timeout` s; blocks until then. Raises OSError."""
    kind = socket.SOCK_DGRAM
    family, _, _, _, where = socket.getaddrinfo(*address, type=kind)[0]
    with socket.socket(family, kind) as probe:
        probe.settimeout(timeout)
        probe.connect(where)
        probe.send(_quic_packet())
        with contextlib.suppress(TimeoutError):
            return _is_version_list(probe.recv(2048))
    return False


def _leave_half_open(probe: socket.socket) -> None:
    """Let the connection end before it is complete: Linux keeps the last packet of the handshake back for 0.2 s."""
    probe.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))
    if hasattr(socket, "TCP_QUICKACK"):
        probe.setsockopt(socket.IPPROTO_TCP, socket.TCP_QUICKACK, 0)


def _quic_packet() -> bytes:
    """Return a packet with a long header, two connection ids and nothing else."""
    ids = b"".join(b"\x08" + os.urandom(8) for _ in range(2))
    return (b"\xc0" + _NO_VERSION + ids).ljust(_QUIC_SIZE, b"\0")


def _is_version_list(data: bytes) -> bool:
    """Return whether a packet is a Version Negotiation packet (RFC 9000, 17.2.1)."""
    return len(data) >= 5 and data[0] & 0x80 != 0 and data[1:5] == bytes(4)
