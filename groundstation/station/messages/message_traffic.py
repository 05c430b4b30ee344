"""Message traffic: every kind of message by its source, received and sent: rate, count, age, the newest one."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from itertools import groupby

import msgspec

from dialects.enum_names import enum_names
from dialects.messages import Message, hide_key
from groundstation.natural_order import natural_key
from groundstation.station.messages.byte_rates import ByteRates
from groundstation.station.messages.message_filter import parse_filter, sorted_rows
from groundstation.station.messages.message_kind import BUCKET, BUCKETS, WINDOW, MessageKind, Tap
from groundstation.station.messages.unknown_messages import UnknownMessages
from groundstation.views.messages import MessageRow, MessagesPage, MessagesRequest
from link.core import LinkReport, SourceCount

MAX_KINDS = 1000
"""Kinds of messages of sources that are not a known vehicle: a flood of invented ids must not grow a table."""

MAX_ROWS = 200
"""Rows in one page, more than any terminal shows."""

ORDER_PERIOD = 1.0
"""s for which an order by changing numbers stays: rows must not jump."""

Source = tuple[bool, int, int]
"""Sent by us, system, component: received ones first, by their ids."""


TrafficKey = tuple[Source, str]
"""A kind of message: its source and its name."""


class MessageTraffic:
    """Kinds of messages by source. `system` and `component` are our ids, under which sent messages are listed."""

    def __init__(self, system: int, component: int) -> None:
        self._own = (True, system, component)
        self._kinds: dict[Source, dict[str, MessageKind]] = {}
        self.unknown = UnknownMessages(WINDOW)
        self._bytes = ByteRates()
        self._size = 0
        self._not_shown = 0
        self._losses: dict[tuple[int, int], SourceCount] = {}
        self._labels: dict[tuple[int, int], str] = {}
        self._order: tuple[float, tuple[str, str], list[tuple[Source, str]]] = (0.0, ("", ""), [])
        """When rows were last sorted, for which order and filter, and the result."""
        self._taps: dict[str, Mapping[TrafficKey, Tap]] = {}
        self._bucket_ends = 0.0

    # ---- counting ----

    def count(self, message: Message, system: int, component: int, now: float, *, known: bool) -> None:
        """Count a received message; `known`: of the autopilot of a known vehicle, which always has a place."""
        self._count((False, system, component), message, now, known=known)

    def count_sent(self, message: Message, now: float) -> None:
        """Count a message that this station sent."""
        self._count(self._own, message, now, known=True)

    def _count(self, source: Source, message: Message, now: float, *, known: bool) -> None:
        if now >= self._bucket_ends:  # no call for each message
            self._end_buckets(now)
        kinds = self._kinds.get(source)
        name = type(message).msgname
        kind = None if kinds is None else kinds.get(name)
        if kind is None:
            if self._size >= MAX_KINDS and not known:
                self._not_shown += 1
                return
            self._size += not known
            taps = self._taps_of((source, name))
            kind = self._kinds.setdefault(source, {})[name] = MessageKind(hide_key(message), taps=taps)
        message = hide_key(message)
        kind.newest, kind.at = message, now
        kind.count += 1
        for tap in kind.taps:
            tap(message, now)

    def _end_buckets(self, now: float) -> None:
        """End the buckets that are over; after a long silence all that count."""
        ended = min(BUCKETS + 1, 1 + int((now - self._bucket_ends) / BUCKET))
        self._bucket_ends = BUCKET * (now // BUCKET + 1)
        for _, kind in self.kinds():
            for _ in range(ended):
                kind.end_bucket()

    def tick(self, now: float) -> None:
        """End what is over, so that the next message, which may be a key's, finds it done."""
        if now >= self._bucket_ends:
            self._end_buckets(now)

    def observe(self, reports: Sequence[LinkReport], now: float) -> None:
        """Handle the unknown messages, and what was lost of each source, from the link that has received most of it."""
        self.unknown.observe(reports, now)
        self._bytes.observe(reports, now)
        for report in reports:
            for ids, counted in report.sources.items():
                if ids not in self._losses or counted.received >= self._losses[ids].received:
                    self._losses[ids] = counted

    def set_labels(self, labels: dict[tuple[int, int], str]) -> None:
        """Set the names of vehicles, by system and component."""
        self._labels = labels

    # ---- for others ----

    def kinds(self) -> Iterator[tuple[TrafficKey, MessageKind]]:
        """Yield all kinds with their places."""
        for source, kinds in self._kinds.items():
            for name, kind in kinds.items():
                yield (source, name), kind

    def find(self, place: TrafficKey) -> MessageKind | None:
        """Return a kind; None before its first message."""
        return self._kinds.get(place[0], {}).get(place[1])

    def set_taps(self, owner: str, taps: Mapping[TrafficKey, Tap]) -> None:
        """Give each message of these kinds to their taps, in place of those that `owner` set before."""
        self._taps[owner] = taps
        for place, kind in self.kinds():
            kind.taps = self._taps_of(place)

    def _taps_of(self, place: TrafficKey) -> tuple[Tap, ...]:
        return tuple(taps[place] for taps in self._taps.values() if place in taps)

    # ---- for the screen ----

    def build_page(self, request: MessagesRequest, now: float, wall: float) -> MessagesPage:
        """Return the rows that a screen shows."""
        self.tick(now)
        every = [row for source in self._sources() for row in self._message_rows(source, now)]
        rows = self._arrange(request, every, now)
        count = max(1, min(request.count, MAX_ROWS))
        first = max(0, min(request.first, len(rows) - count))
        shown = tuple(rows[first : first + count])
        totals = sum(row.rate for row in every), sum(row.bytes for row in every)
        return MessagesPage(
            shown, first, len(rows), len(every), *totals, self._not_shown, request.order, request.text,
            self._bytes.rates,
        )  # fmt: skip

    def _sources(self) -> list[Source]:
        return sorted(self._kinds.keys() | {(False, *ids) for ids in self.unknown.sources})

    def _message_rows(self, source: Source, now: float) -> list[MessageRow]:
        rows: list[MessageRow] = []
        kinds = self._kinds.get(source, {})
        for name in sorted(kinds, key=natural_key):
            kind = kinds[name]
            rate = kind.rate
            rows.append(_row(source, name, rate, rate * kind.length if rate else 0.0, kind.count, now - kind.at))
        if not source[0]:
            rows += self.unknown.build_rows(source[1:], now)
        return rows

    def _arrange(self, request: MessagesRequest, every: list[MessageRow], now: float) -> list[MessageRow]:
        matches = parse_filter(request.text)
        rows = [row for row in map(self._with_lost, every) if matches(row, self._field_names(row))]
        if request.order == "source":
            return self._tree(rows, request.closed)
        at, what, order = self._order
        if what != (request.order, request.text) or now - at >= ORDER_PERIOD:
            order = [(_source(row), row.name) for row in sorted_rows(rows, request.order)]
            self._order = now, (request.order, request.text), order
        found = {(_source(row), row.name): row for row in rows}
        return [found[key] for key in order if key in found]

    def _with_lost(self, row: MessageRow) -> MessageRow:
        counted = None if row.sent else self._losses.get((row.system, row.component))
        return row if counted is None or not counted.lost else msgspec.structs.replace(row, lost=counted.lost)

    def _field_names(self, row: MessageRow) -> Sequence[str]:
        return () if row.unknown else type(self._kinds[_source(row)][row.name].newest).fieldnames

    def _tree(self, rows: Sequence[MessageRow], closed: Sequence[tuple[int, int, bool]]) -> list[MessageRow]:
        """Return the sources, each followed by its messages where it is open."""
        tree: list[MessageRow] = []
        for source, group in groupby(rows, _source):
            messages = list(group)
            tree.append(self._source_row(source, messages))
            if (source[1], source[2], source[0]) not in closed:
                tree += messages
        return tree

    def _source_row(self, source: Source, messages: Sequence[MessageRow]) -> MessageRow:
        sent, *ids = source
        counted = None if sent else self._losses.get((ids[0], ids[1]))
        frames = counted.received + counted.lost if counted else 0
        rate, size = sum(row.rate for row in messages), sum(row.bytes for row in messages)
        return MessageRow(
            ids[0], ids[1], sent, "", rate, size, sum(row.count for row in messages),
            min(row.age for row in messages), self._label(source),
            counted.lost / frames if counted and frames else None, counted.lost if counted else 0,
        )  # fmt: skip

    def _label(self, source: Source) -> str:
        sent, system, component = source
        if sent:
            return "this station"
        kind = enum_names("MAV_COMPONENT").get(component, "component").removeprefix("COMP_ID_")
        return self._labels.get((system, component)) or kind.lower().replace("_", " ")


def _row(source: Source, name: str, rate: float, size: float, count: int, age: float) -> MessageRow:
    sent, system, component = source
    return MessageRow(system, component, sent, name, rate, size, count, age)


def _source(row: MessageRow) -> Source:
    return row.sent, row.system, row.component
