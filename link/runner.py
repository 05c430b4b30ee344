"""Event loop adapter: drives one core with its links, so that cores need neither sockets nor a clock."""

from __future__ import annotations

import asyncio
import logging
import math
import time
from collections.abc import Callable, Hashable, Sequence
from functools import partial

from msgspec.structs import replace

from dialects.codec import EncodeError, encode_payload
from dialects.enums import Severity
from dialects.messages import Message
from link.core import (
    CopyFinder,
    Core,
    EarlyActor,
    LinkReport,
    Onlooker,
    Outgoing,
    PeerReservation,
    Received,
    RefusalListener,
    RestingCore,
    SendGuard,
    SendListener,
    TimeTeller,
)
from link.link_signing import LinkSigning
from link.protocol.channel import Channel
from link.protocol.frame import read_header
from link.protocol.link_events import LinkEvents
from link.protocol.log_tap import LogTap
from link.routing.router import Delivery, Router
from link.runtime.multiples import next_multiple
from link.transport.route import Routes
from link.transport.transport import Link, RoleTransport, SelectiveTransport

log = logging.getLogger(__name__)

REPORT_PERIOD = 1.0
"""s between two calls of core.observe()."""
LONG_ANSWER = 0.05
"""s for `may_send` after which this process has stood still, and the answer may be wrong by now."""

SentCallback = Callable[[Link, Hashable, Message, int, float], None]
"""Takes what was sent: link, address on it, message, packet sequence, time."""


class Runner:
    """Drives a core: delivers and sends messages at once, ticks every `period` s at absolute deadlines.

    With several links it also forwards between them (link/routing/router.py), as MAVLink asks of every system with more
    than one: two ground stations on two links of a vehicle see each other. `route=False` disables that.

    `broken` takes exceptions instead of run(): it may send final messages over links that still work, and then calls
    stop().
    """

    def __init__(
        self,
        core: Core,
        links: Sequence[Link],
        *,
        period: float,
        route: bool | None = None,
        broken: Callable[[Exception], None] | None = None,
        log_tap: LogTap | None = None,
        sent: SentCallback | None = None,
        signing: LinkSigning | None = None,
    ) -> None:
        """`log_tap` records what all links receive and what the core sends, even without any peer.

        `sent` is called for each frame of the core. `signing` guards all links.
        """
        self._signing = signing
        self._core = core
        self._broken = broken
        self._links = {link.channel.index: link for link in links}
        self._period = period
        self._route = route
        self._router: Router | None = None
        self._sent = core.handle_sent if isinstance(core, SendListener) else None
        self._refused = core.handle_refused if isinstance(core, RefusalListener) else None
        self._may_send = core.may_send if isinstance(core, SendGuard) else None
        self._on_sent = sent
        self._reservation = core if isinstance(core, PeerReservation) else None
        self._copies = core if isinstance(core, CopyFinder) else None
        self._teller = core if isinstance(core, TimeTeller) else None
        self._resting = core if isinstance(core, RestingCore) else None
        self._rest: float | None = None
        """s between ticks while the core rests."""
        self._onlooker = core if isinstance(core, Onlooker) else None
        self._interesting: frozenset[int] | None = None
        self._early = core if isinstance(core, EarlyActor) else None
        self._early_timer: asyncio.TimerHandle | None = None
        self._ended: asyncio.Future[None] | None = None
        self._report_due = 0.0
        self._events = LinkEvents()
        self._routes = Routes()
        self._tick_due = 0.0
        self._timer: asyncio.TimerHandle | None = None
        self._log_tap = log_tap
        self._not_encoded: set[int] = set()
        """Ids of messages whose encoding has failed and was logged: a message may be asked for 100 times a second."""
        self._update_router()
        for link in links:
            self._prepare(link)

    @property
    def links(self) -> tuple[Link, ...]:
        """The links, in the order in which they were added."""
        return tuple(self._links.values())

    def add(self, link: Link) -> None:
        """Add an open link while run() runs; the others go on."""
        self._links[link.channel.index] = link
        self._prepare(link)
        if self._router:
            self._router.table.add_link(link.channel.index, *_way(link))
        self._update_router()
        self._start(link)

    def _prepare(self, link: Link) -> None:
        link.channel.log_tap = self._log_tap
        if self._refused and isinstance(link.transport, RoleTransport):
            link.refusal = link.transport.refusal
        if self._onlooker and isinstance(link.transport, SelectiveTransport):
            link.set_interest = link.transport.set_interest
        if self._signing is not None:
            link.channel.guard = self._signing.guard(link.channel.index)
        self._look_at(link)

    def remove(self, index: int) -> None:
        """Close a link and forget it while run() runs; the others go on. An unknown index changes nothing."""
        link = self._links.pop(index, None)
        if link is None:
            return
        link.close()
        if self._router:
            self._router.table.remove_link(index)
        self._update_router()

    def _update_router(self) -> None:
        """Forward between links, as `route` says."""
        links = self.links
        if not links or not (len(links) > 1 if self._route is None else self._route):
            self._router = None
        elif self._router is None:
            self._router = Router((), own=links[0].channel.ids)
            for link in links:
                self._router.table.add_link(link.channel.index, *_way(link))

    async def run(self) -> None:
        """Run until stop(), or until the core raises, and raise that. Closes the links at the end."""
        loop = asyncio.get_running_loop()
        self._ended = loop.create_future()
        self._tick_due = loop.time()
        try:
            for link in self.links:
                self._start(link)
            self._tick()
            await self._ended
        finally:
            for timer in (self._timer, self._early_timer):
                if timer:
                    timer.cancel()
            self._send_remaining()
            for link in self.links:
                link.close()
            if self._signing is not None:
                self._signing.close(loop.time())

    def _start(self, link: Link) -> None:
        index = link.channel.index
        loop = asyncio.get_running_loop()
        link.transport.start(loop, partial(self._deliver, index), partial(self._handle_disconnect, index))

    def stop(self) -> None:
        """End run()."""
        if self._ended and not self._ended.done():
            self._ended.set_result(None)

    def flush(self) -> None:
        """Send the core's messages now, after it was changed by something other than a link."""
        self._guard(self._flush_change)

    def _flush_change(self) -> None:
        self._flush()
        self._shorten_rest()

    def _send_remaining(self) -> None:
        """Send the core's last messages when run() ends, also after an exception."""
        try:
            self._flush()
        except Exception as error:
            log.warning("the last messages could not be sent: %r", error)

    def _guard(self, step: Callable[[], None]) -> None:
        """Run `step`; an exception ends run(), because a callback of the loop has no caller to raise to."""
        if self._ended is None or self._ended.done():
            return
        try:
            step()
            self._plan_early()
        except Exception as error:
            if self._broken is None:
                self._ended.set_exception(error)
            else:
                self._broken(error)

    def _plan_early(self) -> None:
        """Set the timer for what the core has to do before the next tick."""
        if self._early is None:
            return
        due = self._early.due_at
        if self._early_timer is not None and self._early_timer.when() != due:
            self._early_timer.cancel()
            self._early_timer = None
        if due is not None and self._early_timer is None:
            self._early_timer = asyncio.get_running_loop().call_at(due, self._act_early)

    def _act_early(self) -> None:
        self._early_timer = None
        self._guard(self._run_early)

    def _run_early(self) -> None:
        assert self._early is not None
        self._early.act(asyncio.get_running_loop().time())
        self._flush()

    def _deliver(self, index: int, received: Sequence[tuple[bytes, Hashable]]) -> None:
        self._guard(lambda: self._receive(index, received))

    def _handle_disconnect(self, index: int, address: Hashable) -> None:
        if index not in self._links:  # it is being removed
            return
        self._links[index].channel.handle_disconnect(address)
        if self._router:
            self._router.table.handle_disconnect(index, address)

    def _receive(self, index: int, received: Sequence[tuple[bytes, Hashable]]) -> None:
        loop = asyncio.get_running_loop()
        if index not in self._links:
            return
        repeats = True
        channel = self._links[index].channel
        for data, address in received:
            now = loop.time()  # of each: a change behind a repeat moves the ramps in this call, not a cycle later
            repeats &= self._hand_over(channel.receive(data, address, now), now)
            if channel.guard is not None:
                self._tell_time(channel, now)
                repeats = False
        if not repeats:
            self._flush()
            self._shorten_rest()
        if self._router:  # after our own replies, which go first
            self._forward(self._router.receive(index, received, loop.time()))

    def _forward(self, deliveries: Sequence[Delivery]) -> None:
        for index, address, frames in deliveries:
            link = self._links[index]
            for frame in frames:
                header = read_header(frame)
                if header is None or link.channel.may_send(header.message_id, len(frame), address):
                    link.send(frame, address)

    def _hand_over(self, messages: list[Received], now: float) -> bool:
        """Pass messages to the core; return whether there were any, and all were copies of what another link brought.

        Nothing needs to be sent then, which is half of what a copy costs.
        """
        copies = self._copies
        repeats = copies is not None and bool(messages)
        for received in messages:
            self._core.receive(received, now)
            repeats = repeats and copies is not None and copies.repeats
        return repeats

    def _tell_time(self, channel: Channel, now: float) -> None:
        untimely = channel.pop_untimely()
        if self._teller is not None:
            for peer in untimely:
                self._teller.tell_time(peer, now)

    def _tick(self) -> None:
        self._guard(self._run_tick)
        loop = asyncio.get_running_loop()
        # Absolute deadlines do not drift. After a pause missed ticks are skipped.
        self._rest = self._resting.rest_period if self._resting is not None else None
        if self._rest is not None:
            self._tick_due = next_multiple(self._rest, loop.time())
        else:
            self._tick_due = max(self._tick_due + self._period, loop.time())
        self._timer = loop.call_at(self._tick_due, self._tick)

    def _shorten_rest(self) -> None:
        """Tick as soon as the loop is free if the core has got something to do."""
        if self._rest is None or self._resting is None or self._timer is None:
            return
        rest = self._resting.rest_period
        if rest is not None and rest >= self._rest:
            return
        loop, self._rest = asyncio.get_running_loop(), None
        self._timer.cancel()
        self._tick_due = loop.time()
        self._timer = loop.call_at(self._tick_due, self._tick)

    def _run_tick(self) -> None:
        now = asyncio.get_running_loop().time()
        for link in self.links:
            if found := link.channel.tick(now):
                self._hand_over(found, now)
            for data, address in link.channel.questions(now):
                link.send(data, address)
        if self._router:
            self._forward(self._router.tick(now))
        if now >= self._report_due:
            self._report_due = now + REPORT_PERIOD
            self._observe(now)
        self._core.tick(now)
        self._update_looks()
        self._flush()

    def _update_looks(self) -> None:
        """Tell the links that can choose which vehicles are looked at, if that has changed."""
        if self._onlooker is None:
            return
        links = [link for link in self._links.values() if link.set_interest is not None]
        if not links:
            return
        systems = self._onlooker.interesting_systems
        if systems != self._interesting:
            self._interesting = systems
            for link in links:
                self._look_at(link)

    def _look_at(self, link: Link) -> None:
        if link.set_interest is not None:
            link.set_interest(self._interesting)
            link.channel.set_interest(self._interesting, time.monotonic())

    def observe(self) -> None:
        """Report the links to the core now, beside the reports each REPORT_PERIOD."""
        self._observe(time.monotonic())

    def _observe(self, now: float) -> None:
        if self._signing is not None:
            self._signing.update(now)
        for link in self.links:
            link.channel.expire_peers(now)
            if self._reservation is not None:
                link.channel.reserve(self._reservation.reserved_ids)
        reports = [self._report(link, now) for link in self.links]
        for report in reports:
            if event := self._events.update(report):
                level = logging.WARNING if event.severity <= Severity.ERROR else logging.INFO
                log.log(level, "%s: %s", report.name, event.text)
        self._core.observe(reports, now)

    def _report(self, link: Link, now: float) -> LinkReport:
        report = link.channel.report(link.transport.problem, now=now, dropped=link.transport.dropped)
        return replace(
            report,
            frames_sent=link.frames_sent,
            bytes_sent=link.bytes_sent,
            watch_only=link.watch_only,
            routes=self._routes.find(link.transport, report.audience, now),
        )

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
        payload, taken, refusal = encode_payload(outgoing.message), False, None
        allowed_at, clock = -math.inf, asyncio.get_running_loop().time
        for link in self._links.values():
            if link.watch_only:
                continue
            for data, address, sequence in link.channel.send(outgoing, payload, clock()):
                now = clock()  # of each: this process may have stood still in the send before
                if now - allowed_at >= LONG_ANSWER:  # else the answer is as fresh as one for this frame alone may be
                    if not self._is_allowed(outgoing.message):
                        return
                    allowed_at, now = now, clock()
                why = link.send(data, address)
                taken, refusal = taken or why is None, refusal or why
                if self._sent:
                    self._sent(outgoing.message, sequence, now)
                if self._on_sent:
                    self._on_sent(link, address, outgoing.message, sequence, now)
        self._note_sent(outgoing.message, payload, None if taken else refusal, taken=taken)

    def _is_allowed(self, message: Message) -> bool:
        """Ask the core whether a message may be sent now, again if this process stood still during the answer."""
        if self._may_send is None:
            return True
        time = asyncio.get_running_loop().time
        while self._may_send(message, now := time()):
            if time() - now < LONG_ANSWER:
                return True
        return False

    def _note_sent(self, message: Message, payload: bytes, refusal: str | None, *, taken: bool) -> None:
        """Record what was sent, and tell the core of what its role does not allow."""
        if refusal and self._refused:
            self._refused(message, refusal, asyncio.get_running_loop().time())
        if self._log_tap and (taken or self._log_tap.unsent):
            self._log_tap.record_sent(type(message).id, payload, asyncio.get_running_loop().time())


def _way(link: Link) -> tuple[bool, Hashable | None]:
    """Return what the route table must know of a link; one that only watches has no address to send to."""
    return link.transport.stream, None if link.watch_only else link.transport.fixed_address
