"""The only loop: drives one core with its links. It knows sockets and time so that no core has to."""

from __future__ import annotations

import asyncio
import logging
from collections.abc import Callable, Hashable, Sequence
from functools import partial
from typing import Protocol, runtime_checkable

from dialects.codec import EncodeError, encode_payload
from dialects.enums import Severity
from dialects.messages import Message
from link.core import Core, LinkReport, Outgoing, Received
from link.protocol.channel import Channel
from link.protocol.link_events import LinkEvents
from link.protocol.log_tap import LogTap
from link.routing.router import Delivery, Router
from link.transport.transport import Link
from link.transport.transports import open_transports

log = logging.getLogger(__name__)

REPORT_PERIOD = 1.0
"""s between two core.observe()."""


@runtime_checkable
class SendListener(Protocol):
    """A core that wants to know which packet sequence its messages got."""

    def handle_sent(self, message: Message, sequence: int, now: float) -> None:
        """`message` went out under this number."""


def open_links(
    endpoints: Sequence[str], *, system: int, component: int, wanted: frozenset[int] | None = None
) -> list[Link]:
    """Open all endpoints, or none: raises EndpointError or LinkError. `wanted`: see Channel."""
    return [
        Link(
            wire,
            Channel(
                wire.endpoint.text,
                index,
                system=system,
                component=component,
                stream=wire.stream,
                wanted=wanted,
                target=wire.fixed_address,
                capacity=wire.capacity,
            ),
        )
        for index, wire in enumerate(open_transports(endpoints))
    ]


class Runner:
    """Drives `core`: messages in at once, messages out at once, a tick every `period` s at absolute deadlines.

    With several links it also forwards between them (link/routing/router.py), as MAVLink asks of every system that has more than
    one: two ground stations on two links of a vehicle hear each other. `route` false leaves that out.

    `broken` takes what goes wrong inside instead of run(): who names it may say last words over links that still work,
    and then calls stop().
    """

    def __init__(
        self,
        core: Core,
        links: Sequence[Link],
        *,
        period: float,
        route: bool | None = None,
        broken: Callable[[Exception], None] | None = None,
        tape: LogTap | None = None,
    ) -> None:
        """`tape` takes what all links hear, and what the core says, also where nobody listens."""
        self._core = core
        self._broken = broken
        self._links = links
        self._period = period
        self._router = _router(links) if links and (len(links) > 1 if route is None else route) else None
        self._sent = core.handle_sent if isinstance(core, SendListener) else None
        self._ended: asyncio.Future[None] | None = None
        self._report_due = 0.0
        self._troubles = LinkEvents()
        self._tick_due = 0.0
        self._timer: asyncio.TimerHandle | None = None
        self._tape = tape
        self._not_encoded: set[int] = set()
        """Ids of messages whose encoding has failed and was logged: a message may be asked for 100 times a second."""
        for link in links:
            link.channel.log_tap = tape

    async def run(self) -> None:
        """Run until stop() or until the core raises; that exception is raised here. Closes the links at the end."""
        loop = asyncio.get_running_loop()
        self._ended = loop.create_future()
        self._tick_due = loop.time()
        try:
            for index, link in enumerate(self._links):
                link.transport.start(loop, partial(self._deliver, index), partial(self._handle_disconnect, index))
            self._tick()
            await self._ended
        finally:
            if self._timer:
                self._timer.cancel()
            self._send_remaining()
            for link in self._links:
                link.close()

    def stop(self) -> None:
        """Let run() return."""
        if self._ended and not self._ended.done():
            self._ended.set_result(None)

    def flush(self) -> None:
        """Send what the core has now: for cores that are told things from elsewhere than a link."""
        self._guard(self._flush)

    def _send_remaining(self) -> None:
        """What the core still says when it ends, also after an exception of its own."""
        try:
            self._flush()
        except Exception as error:
            log.warning("the last messages could not be sent: %r", error)

    def _guard(self, step: Callable[[], None]) -> None:
        """Callbacks of the loop have no caller to raise to: what goes wrong in one ends run()."""
        if self._ended is None or self._ended.done():
            return
        try:
            step()
        except Exception as error:
            if self._broken is None:
                self._ended.set_exception(error)
            else:
                self._broken(error)

    def _deliver(self, index: int, pieces: Sequence[tuple[bytes, Hashable]]) -> None:
        self._guard(lambda: self._receive(index, pieces))

    def _handle_disconnect(self, index: int, address: Hashable) -> None:
        self._links[index].channel.handle_disconnect(address)
        if self._router:
            self._router.table.handle_disconnect(index, address)

    def _receive(self, index: int, pieces: Sequence[tuple[bytes, Hashable]]) -> None:
        now = asyncio.get_running_loop().time()
        for data, address in pieces:
            self._hand_over(self._links[index].channel.receive(data, address, now), now)
        self._flush()
        if self._router:  # after our own answers: what is for us comes first
            self._forward(self._router.receive(index, pieces, now))

    def _forward(self, deliveries: Sequence[Delivery]) -> None:
        for port, address, frames in deliveries:
            for frame in frames:
                self._links[port].transport.send(frame, address)

    def _hand_over(self, messages: list[Received], now: float) -> None:
        for received in messages:
            self._core.receive(received, now)

    def _tick(self) -> None:
        self._guard(self._run_tick)
        loop = asyncio.get_running_loop()
        # Absolute deadlines do not drift; after a pause the missed ticks are skipped, not made up for.
        self._tick_due = max(self._tick_due + self._period, loop.time())
        self._timer = loop.call_at(self._tick_due, self._tick)

    def _run_tick(self) -> None:
        now = asyncio.get_running_loop().time()
        for link in self._links:
            self._hand_over(link.channel.tick(now), now)
        if self._router:
            self._forward(self._router.tick(now))
        if now >= self._report_due:
            self._report_due = now + REPORT_PERIOD
            self._observe(now)
        self._core.tick(now)
        self._flush()

    def _observe(self, now: float) -> None:
        for link in self._links:
            link.channel.expire_peers(now)
        reports = [self._report(link, now) for link in self._links]
        for report in reports:
            if news := self._troubles.update(report):
                level = logging.WARNING if news.severity <= Severity.ERROR else logging.INFO
                log.log(level, "%s: %s", report.name, news.text)
        self._core.observe(reports, now)

    @staticmethod
    def _report(link: Link, now: float) -> LinkReport:
        return link.channel.report(link.transport.problem, now=now, dropped=link.transport.dropped)

    def _flush(self) -> None:
        for outgoing in self._core.messages_to_send():
            try:
                self._send(outgoing)
            except EncodeError as error:
                self._log_not_encoded(outgoing.message, error)

    def _log_not_encoded(self, message: Message, error: EncodeError) -> None:
        number = type(message).id
        if number not in self._not_encoded:
            self._not_encoded.add(number)
            log.error("a message could not be encoded and was not sent: %s", error)

    def _send(self, outgoing: Outgoing) -> None:
        payload = encode_payload(outgoing.message)
        for link in self._links:
            for data, address, sequence in link.channel.send(outgoing, payload):
                link.transport.send(data, address)
                if self._sent:
                    self._sent(outgoing.message, sequence, asyncio.get_running_loop().time())
        if self._tape:
            self._tape.record_sent(type(outgoing.message).id, payload, asyncio.get_running_loop().time())


def _router(links: Sequence[Link]) -> Router:
    return Router([(link.transport.stream, link.transport.fixed_address) for link in links], own=links[0].channel.ids)
