"""Door of the web server: connections that have not asked for anything with the token, in number and in time.

Every user of this machine may connect. Without a bound, a thousand connections that say nothing, or nothing that is
right, use up the descriptors, and no page is shown any more. Tabs that are open are not counted: they were admitted.
"""

from __future__ import annotations

import asyncio
import logging
import math
import time
from collections.abc import Callable

MAX_WAITING = 32
"""Connections without a request that was admitted. One more closes the one that has waited longest: browsers ask at
once."""
REQUEST_WITHIN = 5.0
"""s for a request to arrive, and for the next one over the same connection."""
LINES, MINUTE = 20, 60.0
"""Lines of the log in that many s: who sends rubbish does not fill the disk."""


class Door:
    """Lets connections in. `make` returns the protocol that serves one."""

    def __init__(
        self, make: Callable[[], asyncio.Protocol], *, places: int = MAX_WAITING, within: float = REQUEST_WITHIN
    ) -> None:
        self._make, self._places, self._within = make, places, within
        self._waiting: dict[asyncio.BaseTransport, asyncio.TimerHandle] = {}
        """Connection that was not admitted -> the timer that ends it, the oldest first."""

    def __call__(self) -> asyncio.Protocol:
        """Return what takes a new connection, and hands it to the protocol that serves."""
        return _Arrival(self)

    def admit(self, transport: asyncio.BaseTransport | None) -> None:
        """Note that a request which is not refused has come over a connection; None if that has ended."""
        if transport is not None and (timer := self._waiting.pop(transport, None)):
            timer.cancel()

    def take(self, transport: asyncio.Transport) -> asyncio.Protocol:
        """Count a new connection; return the protocol that serves it."""
        self._waiting = {each: timer for each, timer in self._waiting.items() if not each.is_closing()}
        if len(self._waiting) >= self._places:
            self._end(next(iter(self._waiting)))
        loop = asyncio.get_running_loop()
        self._waiting[transport] = loop.call_later(self._within, self._end, transport)
        return self._make()

    def _end(self, transport: asyncio.BaseTransport) -> None:
        assert isinstance(transport, asyncio.Transport)
        transport.abort()


class _Arrival(asyncio.Protocol):
    """The first moment of a connection."""

    def __init__(self, door: Door) -> None:
        self._door = door

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        assert isinstance(transport, asyncio.Transport)
        protocol = self._door.take(transport)
        transport.set_protocol(protocol)
        protocol.connection_made(transport)


class FewLines:
    """A filter of a logger, which lets LINES records through in a minute.

    `brief` are errors without a traceback and without their text, which has words of the stranger who made them.
    """

    def __init__(
        self, clock: Callable[[], float] = time.monotonic, brief: tuple[type[BaseException], ...] = ()
    ) -> None:
        self._clock, self._brief = clock, brief
        self._since, self._count = -math.inf, 0

    def filter(self, record: logging.LogRecord) -> bool:
        """Return whether a record is written."""
        now = self._clock()
        if now - self._since >= MINUTE:
            self._since, self._count = now, 0
        self._count += 1
        error = record.exc_info[1] if record.exc_info else None
        if isinstance(error, self._brief):
            record.msg, record.args = f"{record.getMessage()}: {type(error).__name__}", ()
            record.exc_info = None
        return self._count <= LINES
