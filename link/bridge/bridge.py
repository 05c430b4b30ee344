"""Forwards frames between transports at once, as link/routing/router.py decides."""

from __future__ import annotations

import asyncio
from bisect import bisect_right
from collections.abc import Callable, Hashable, Sequence
from functools import partial
from itertools import accumulate

from link.bridge.status import BridgeStatus, StatusMeter
from link.routing.router import Delivery, Router
from link.tlog.recorder import Recorder
from link.transport.transport import Transport

TICK = 0.05
"""s between two checks for partial frames and silent peers: half of framer.PARTIAL_DEADLINE."""
STATUS_PERIOD = 1.0
"""s between two status reports."""
DATAGRAM = 1400
"""Bytes of a datagram with several frames, at most: below every usual MTU."""


class Bridge:
    """Forwards frames between transports until stop().

    `on_status` gets the status once a second, `recorder` every frame.

    `join` puts frames that wait at the same time into one datagram; none is ever delayed for that. False is for
    receivers that read only the first frame of a datagram.
    """

    def __init__(
        self,
        transports: Sequence[Transport],
        on_status: Callable[[BridgeStatus], None],
        *,
        recorder: Recorder | None = None,
        join: bool = True,
    ) -> None:
        self._transports = transports
        self._on_status = on_status
        self._recorder = recorder
        self._join = join
        self._router = Router([(transport.stream, transport.fixed_address) for transport in transports])
        self._router.captured = [] if recorder else None
        self._meter = StatusMeter(transports, self._router)
        self._loop = asyncio.get_running_loop()
        self._ended: asyncio.Future[None] = self._loop.create_future()

    async def run(self) -> None:
        """Forward until stop(); close the transports at the end."""
        timers = [
            self._loop.create_task(self._every(period, step))
            for period, step in ((TICK, self._tick), (STATUS_PERIOD, self._report_status))
        ]
        for timer in timers:
            timer.add_done_callback(self._timer_ended)
        try:
            for link, transport in enumerate(self._transports):
                transport.start(
                    self._loop, partial(self._receive, link), partial(self._router.table.handle_disconnect, link)
                )
            await self._ended
        finally:
            for timer in timers:
                timer.cancel()
            for transport in self._transports:
                transport.close()

    def stop(self) -> None:
        """End run()."""
        if not self._ended.done():
            self._ended.set_result(None)

    def _timer_ended(self, timer: asyncio.Task[None]) -> None:
        """End the bridge if a timer has failed; timers end in no other way but by cancel()."""
        if not timer.cancelled() and (fault := timer.exception()) and not self._ended.done():
            self._ended.set_exception(fault)

    def _receive(self, link: int, pieces: Sequence[tuple[bytes, Hashable]]) -> None:
        for delivery in self._router.receive(link, pieces, self._loop.time()):
            self._send(delivery)
        if self._recorder:
            self._record(self._recorder)

    def _send(self, delivery: Delivery) -> None:
        link, address, frames = delivery
        transport = self._transports[link]
        if len(frames) > 1 and self._join and not transport.stream:
            frames = join_frames(frames)
        for data in frames:
            transport.send(data, address)

    def _record(self, recorder: Recorder) -> None:
        frames = self._router.captured
        if frames:
            self._router.captured = []
            recorder.add(self._loop.time(), frames)

    def _tick(self) -> None:
        for delivery in self._router.tick(self._loop.time()):
            self._send(delivery)
        if self._recorder:
            self._record(self._recorder)
            self._recorder.tick(self._loop.time())

    def _report_status(self) -> None:
        problem = self._recorder.problem if self._recorder else None
        self._on_status(self._meter.read(self._loop.time(), problem and f"recording: {problem}"))

    async def _every(self, period: float, step: Callable[[], None]) -> None:
        due = self._loop.time()
        while True:
            step()
            due = max(due + period, self._loop.time())
            await asyncio.sleep(due - self._loop.time())


def join_frames(frames: Sequence[bytes]) -> list[bytes]:
    """Join frames into datagrams of at most DATAGRAM bytes, in order; no frame is split."""
    ends = list(accumulate(map(len, frames)))
    datagrams: list[bytes] = []
    first = before = 0
    while first < len(frames):
        after = max(first + 1, bisect_right(ends, before + DATAGRAM))
        datagrams.append(b"".join(frames[first:after]))
        first, before = after, ends[after - 1]
    return datagrams
