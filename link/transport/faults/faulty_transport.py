"""FaultyTransport: a link with faults. LinkFaults: those of all links of a vehicle."""

from __future__ import annotations

import asyncio
from collections.abc import Hashable, Sequence

from link.transport.faults.link_cut import LinkCut
from link.transport.faults.settings import FaultSettings
from link.transport.memory import LossyPipe
from link.transport.transport import DisconnectCallback, Outlet, ReceiveCallback, Transport

MOST_UNDER_WAY = 10_000
"""Frames that one direction keeps; those beyond are lost. 60 s of delay at 100 frames/s fit."""


Packet = tuple[bytes, Hashable]
"""A datagram or a piece of a stream, and its address."""


class FaultyTransport:
    """A transport whose frames are lost, late or cut off. On a stream each piece that is read or written counts as one.

    A connection that begins or ends is reported at once.
    """

    def __init__(self, inner: Transport, settings: FaultSettings, cut: LinkCut, number: int) -> None:
        """Wrap a transport. `number` tells links of one vehicle apart, so that they lose other frames."""
        self._inner, self._cut, self.endpoint = inner, cut, inner.endpoint
        self.stream, self.fixed_address, self.capacity = inner.stream, inner.fixed_address, inner.capacity
        self._up, self._down = (
            LossyPipe[Packet](
                delay=settings.delay,
                jitter=settings.jitter,
                loss=settings.loss,
                seed=2 * (settings.seed + number) + way,
            )
            for way in (0, 1)
        )
        self._loop: asyncio.AbstractEventLoop | None = None
        self._timer: asyncio.TimerHandle | None = None
        self._on_receive: ReceiveCallback = lambda batch: None

    @property
    def problem(self) -> str | None:
        """That of the transport."""
        return self._inner.problem

    @property
    def dropped(self) -> int:
        """That of the transport: what is lost on purpose looks like loss of the network, not like a full buffer."""
        return self._inner.dropped

    def start(
        self, loop: asyncio.AbstractEventLoop, on_receive: ReceiveCallback, on_disconnect: DisconnectCallback
    ) -> None:
        """Start the transport, and deliver what it receives when the faults let it pass."""
        self._loop, self._on_receive = loop, on_receive
        self._inner.start(loop, self._take, on_disconnect)

    def send(self, data: bytes, address: Hashable) -> None:
        """Send one frame when the faults let it pass, or never."""
        if self._loop is not None:
            self._put(self._down, (data, address), self._loop.time())
            self._pass_on()

    def outlet(self, address: Hashable) -> Outlet | None:
        """Return None: a copy of the descriptor would pass by the faults."""
        return None

    def close(self) -> None:
        """Close the transport; what is under way is lost."""
        if self._timer is not None:
            self._timer.cancel()
        self._loop = None
        self._inner.close()

    def _take(self, batch: Sequence[Packet]) -> None:
        assert self._loop is not None
        if begun := [packet for packet in batch if not packet[0]]:
            self._on_receive(begun)
        now = self._loop.time()
        for packet in batch:
            if packet[0]:
                self._put(self._up, packet, now)
        self._pass_on()

    def _put(self, pipe: LossyPipe[Packet], packet: Packet, now: float) -> None:
        pipe.cut = self._cut.active(now)
        if pipe.waiting < MOST_UNDER_WAY:
            pipe.send(packet, now)

    def _pass_on(self) -> None:
        """Deliver what has arrived in both directions, and come back for the next frame."""
        if self._loop is None:
            return
        now = self._loop.time()
        self._up.cut = self._down.cut = self._cut.active(now)
        for data, address in self._down.receive(now):
            self._inner.send(data, address)
        if arrived := self._up.receive(now):
            self._on_receive(arrived)
        times = [each for each in (self._up.next_arrival, self._down.next_arrival) if each is not None]
        if self._timer is not None:
            self._timer.cancel()
        self._timer = self._loop.call_at(min(times), self._pass_on) if times and self._loop is not None else None


class LinkFaults:
    """The faults of all links of a vehicle."""

    def __init__(self, settings: FaultSettings) -> None:
        self._settings = settings
        self._cut = LinkCut(settings.cut)
        self._links = 0

    def wrap(self, transport: Transport) -> Transport:
        """Return a transport with the faults around this one."""
        self._links += 1
        return FaultyTransport(transport, self._settings, self._cut, self._links)

    def update(self, turning: bool, now: float) -> None:
        """Follow the wheels. Call it in each control cycle."""
        self._cut.update(turning, now)
