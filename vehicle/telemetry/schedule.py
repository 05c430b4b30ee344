"""The streams of one peer: its rates, its dialect level, and its share of the link."""

from __future__ import annotations

import math
from collections.abc import Callable, Collection
from heapq import heappop, heappush
from typing import NamedTuple

import msgspec

from dialects.codec import MAX_FRAME
from dialects.enums import DataStream
from link.protocol.rate import TokenBucket
from vehicle.telemetry.streams import STREAM_BY_ID, STREAMS, DialectLevel, Stream

PEER_MESSAGE_RATE_MAX = 200.0
"""Streamed messages/s to one peer at most: about 60 kbit/s of 40-byte frames."""
MIN_INTERVAL = 0.02
"""s; a stream cannot be faster than the control cycle."""
CHANGE_GAP = 0.05
"""s between two messages of a stream that is sent on change: 20 Hz."""
PHASE = 0.02
"""s between the first messages of neighbouring streams, to spread the first burst."""
BURST = 0.3
"""s; burst size of a limit in messages/s."""
BYTES_BURST = 0.05
"""s; burst size of a limit in bytes/s, but never less than the largest frame: bursts delay a slow link."""
STEADY = 0.5
"""Share of a limit that one steady stream may use, its changes included, so that the others do not starve."""
LEAST_ROOM = 0.1
"""Share of a limit that is left to the others if steady streams need all of it."""
RADIO_STRETCH_MAX = 8.0
"""Largest factor by which a full radio stretches the intervals."""
RADIO_SILENCE = 5.0
"""s without RADIO_STATUS until its effect ends; a radio reports once a second."""
EARLY = 1e-6
"""s; a message is due this much early, or rounding would delay it by a cycle."""


class BandwidthShare(NamedTuple):
    """What one peer may use of its link."""

    messages: float = PEER_MESSAGE_RATE_MAX
    """Messages/s."""
    bytes: float | None = None
    """Bytes/s; None if the capacity of the link is unknown."""


class _Clock(msgspec.Struct):
    """When one stream is due. Without an interval it is sent on request, and on change while `on`."""

    stream: Stream
    origin: float
    on: bool = False
    interval: float | None = None
    due: float = math.inf
    sent: float = -math.inf

    def next(self, step: float, now: float) -> float:
        """Return the next of the times `origin` + n x `step`; times missed in a pause are skipped.

        They are the same for all peers with this step, so that one message serves them all.
        """
        number = math.floor((now + 2 * EARLY - self.origin) / step) + 1
        return self.origin + number * step - EARLY


class StreamSchedule:
    """The streams of one peer, at first those of DialectLevel.COMMON, one after the other."""

    def __init__(self, boot: float, now: float) -> None:
        """`boot` is the time from which the due times of all peers are counted."""
        self.level = DialectLevel.COMMON
        """The highest level that the peer has shown to understand."""
        self._clocks = {each.message.id: _Clock(each, boot + n * PHASE) for n, each in enumerate(STREAMS)}
        self._steady = [clock for clock in self._clocks.values() if clock.stream.steady]
        self._queue: list[tuple[float, int]] = []
        """A heap of due times and message ids; entries of a time that is no longer that of the stream are void."""
        self._share = BandwidthShare()
        self._messages = TokenBucket(PEER_MESSAGE_RATE_MAX, PEER_MESSAGE_RATE_MAX * BURST)
        self._bytes: TokenBucket | None = None
        self._stretch, self._radio_heard = 1.0, -math.inf
        """Factor on the intervals while the buffer of a radio is full."""
        self._narrow = 1.0
        """Factor on the intervals if the requested rates exceed the share."""
        self._begin((DialectLevel.COMMON,), now)

    def raise_level(self, level: DialectLevel, now: float) -> None:
        """Start the streams up to `level`, which the peer understands."""
        if level > self.level:
            self._begin([each for each in DialectLevel if self.level < each <= level], now)
            self.level = level

    @property
    def steady_due(self) -> float:
        """When the first steady stream is due."""
        due = math.inf
        for clock in self._steady:
            due = min(due, clock.due)
        return due

    @property
    def shortest(self) -> float:
        """The shortest interval of a stream, s."""
        return min((each.interval for each in self._clocks.values() if each.interval is not None), default=math.inf)

    def interval(self, message_id: int) -> float | None:
        """Return the interval of a stream in s, None without a rate. Raises KeyError if it is not a stream."""
        return self._clocks[message_id].interval

    def set_interval(self, message_id: int, interval: float | None, now: float) -> None:
        """Set the interval of a stream; None turns it off. MIN_INTERVAL at least; a fixed rate stays.

        An unchanged interval, which MAVProxy requests all the time, sends no message.
        """
        clock = self._clocks[message_id]
        on, interval = interval is not None, interval and max(MIN_INTERVAL, interval)
        if not clock.stream.fixed_rate and (on, interval) != (clock.on, clock.interval):
            self._set(message_id, on, interval, now)
            self._narrow = self._narrowed()

    def set_default(self, message_id: int, now: float) -> None:
        """Reset a stream to its rate in STREAMS."""
        if not STREAM_BY_ID[message_id].fixed_rate:
            self._set_default(STREAM_BY_ID[message_id], now)
            self._narrow = self._narrowed()

    def set_group(self, group: int, rate: float, now: float) -> None:
        """Set the rate of all streams of a REQUEST_DATA_STREAM group; 0 turns them off."""
        for stream in STREAMS:
            if stream.group is not None and group in (DataStream.ALL, stream.group):
                self.set_interval(stream.message.id, _interval(rate), now)

    def set_share(self, share: BandwidthShare) -> None:
        """Limit messages and bytes of all streams together. They slow down alike, steady ones last."""
        if share == self._share:
            return
        self._share = share
        self._messages.set_rate(share.messages, max(1.0, share.messages * BURST))
        if share.bytes is None:
            self._bytes = None
        else:
            rate, burst = max(0.0, share.bytes - _FIXED), max(share.bytes * BYTES_BURST, MAX_FRAME)
            self._bytes = self._bytes or TokenBucket(rate, burst)
            self._bytes.set_rate(rate, burst)
        self._narrow = self._narrowed()

    def handle_radio_status(self, free: int, now: float) -> None:
        """Slow down while the buffer of a radio fills, and speed up when it is empty; `free` is in percent."""
        self._radio_heard = now
        if free < 50:
            self._stretch = min(RADIO_STRETCH_MAX, self._stretch * 2)
        elif free > 90:
            self._stretch = max(1.0, self._stretch / 2)

    def expedite(self, message_id: int, now: float) -> None:
        """Make a stream due now, or as soon as CHANGE_GAP allows: its content has changed."""
        clock = self._clocks[message_id]
        if clock.on:
            self._set_due(clock, min(clock.due, max(now, clock.sent + max(CHANGE_GAP, self._least(clock.stream)))))

    def pop_due(self, now: float) -> list[Stream]:
        """Return the streams that are due and have room; they count as sent."""
        due: dict[int, _Clock] = {}
        while self._queue and now >= self._queue[0][0]:
            time, number = heappop(self._queue)
            if self._clocks[number].due == time:
                due[number] = self._clocks[number]
        taken = []
        for clock in sorted(due.values(), key=lambda each: (not each.stream.steady, each.due)):
            if self._take(clock, now):
                taken.append(clock.stream)
            else:  # no room: it stays due, and gets its turn when it is the oldest
                heappush(self._queue, (clock.due, clock.stream.message.id))
        return taken

    def pop_if_due(self, message_id: int, now: float) -> bool:
        """Return whether one stream is due and has room; it counts as sent then."""
        clock = self._clocks[message_id]
        return now >= clock.due and self._take(clock, now)

    def _take(self, clock: _Clock, now: float) -> bool:
        stream = clock.stream
        if not (stream.fixed_rate or self._room(stream, now)):
            return False
        clock.sent = now
        self._set_due(clock, self._next_due(clock, now))
        return True

    def _set_due(self, clock: _Clock, due: float) -> None:
        if due != clock.due:
            clock.due = due
            if due < math.inf:
                heappush(self._queue, (due, clock.stream.message.id))

    def _next_due(self, clock: _Clock, now: float) -> float:
        """Return when a stream is due again, as the link allows; a steady one may just have been expedited."""
        if clock.interval is None:
            return math.inf
        if clock.stream.steady:
            least = self._least(clock.stream)
            return max(clock.next(max(clock.interval, least), now), now + least - EARLY)
        return clock.next(clock.interval * max(self._stretched(now), self._narrow), now)

    def _least(self, stream: Stream) -> float:
        """Return the s between two messages of a steady or expedited stream that leave room for the others."""
        share = self._share
        return max(1 / share.messages, stream.size / share.bytes if share.bytes else 0.0) / STEADY

    def _stretched(self, now: float) -> float:
        if now - self._radio_heard > RADIO_SILENCE:
            self._stretch = 1.0
        return self._stretch

    def _room(self, stream: Stream, now: float) -> bool:
        return self._messages.consume(now) and (self._bytes is None or self._bytes.consume(now, stream.size))

    def _begin(self, levels: Collection[DialectLevel], now: float) -> None:
        new = [stream for stream in STREAMS if stream.level in levels and _is_default_on(stream)]
        for number, stream in enumerate(new):
            self._set_default(stream, now + number * PHASE)
        self._narrow = self._narrowed()

    def _set_default(self, stream: Stream, due: float) -> None:
        self._set(stream.message.id, _is_default_on(stream), _interval(stream.rate), due)

    def _set(self, message_id: int, on: bool, interval: float | None, due: float) -> None:
        clock = self._clocks[message_id]
        clock.on, clock.interval = on, interval
        self._set_due(clock, due if on else math.inf)

    def _narrowed(self) -> float:
        messages = self._excess(self._share.messages, lambda stream: 1.0)
        return max(1.0, messages, self._excess(self._share.bytes, lambda stream: stream.size))

    def _excess(self, limit: float | None, weight: Callable[[Stream], float]) -> float:
        """Return by which factor the streams that can slow down exceed a limit, in messages or bytes."""
        if limit is None:
            return 1.0
        steady = others = 0.0
        for clock in self._clocks.values():
            if clock.interval is not None and clock.stream.steady:
                steady += weight(clock.stream) / max(clock.interval, self._least(clock.stream))
            elif clock.interval is not None:
                others += weight(clock.stream) / clock.interval
        return others / max(limit - steady, limit * LEAST_ROOM)


def _is_default_on(stream: Stream) -> bool:
    """Return whether a stream is sent without a request: at its rate, or on change."""
    return stream.rate > 0 or stream.change_key is not None


def _interval(rate: float) -> float | None:
    return 1.0 / rate if rate > 0 else None


_FIXED = sum(stream.size * stream.rate for stream in STREAMS if stream.fixed_rate)
"""Bytes/s of the streams that are sent without regard to the share."""
