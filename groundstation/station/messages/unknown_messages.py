"""Messages with ids outside the dialect, as the links count them: rate, count, age, length, but no fields."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

import msgspec

from groundstation.views.messages import MessageRequest, MessageRow, MessageView
from link.core import LinkReport
from link.protocol.rate import RateMeter

MARK = "#"
"""Stands before the id in the name of a row; names of messages have letters only."""

Ids = tuple[int, int]
"""System and component."""


class _Unknown(msgspec.Struct):
    meter: RateMeter
    count: int = 0
    length: int = 0
    """Bytes of the newest frame."""
    at: float = 0.0


class UnknownMessages(msgspec.Struct):
    """Kinds of unknown messages by source; at most as many as the links count. `window`: s of the rates."""

    window: float
    _kinds: dict[Ids, dict[int, _Unknown]] = msgspec.field(default_factory=dict)

    def observe(self, reports: Iterable[LinkReport], now: float) -> None:
        """Store the counts of all links, about once a second."""
        totals: dict[tuple[int, int, int], tuple[int, int]] = {}
        for report in reports:
            for key, (frames, length) in report.unknown_ids.items():
                totals[key] = totals.get(key, (0, 0))[0] + frames, length
        for (system, component, number), (count, length) in totals.items():
            kinds = self._kinds.setdefault((system, component), {})
            kind = kinds.setdefault(number, _Unknown(RateMeter(self.window)))
            if count > kind.count:
                kind.meter.add(now, count - kind.count)
                kind.count, kind.length, kind.at = count, length, now

    @property
    def sources(self) -> Iterable[Ids]:
        """Systems and components that send any."""
        return self._kinds.keys()

    def build_rows(self, ids: Ids, now: float) -> Iterator[MessageRow]:
        """Yield the rows of a source, in order of the ids."""
        for number, kind in sorted(self._kinds.get(ids, {}).items()):
            rate = kind.meter.rate(now)
            yield MessageRow(
                *ids, False, f"{MARK}{number}", rate, rate * kind.length, kind.count, now - kind.at,
                label=f"{kind.length} B", unknown=True,
            )  # fmt: skip

    def build_message(self, request: MessageRequest, now: float) -> MessageView | None:
        """Return what is known of a message; None for one that is not counted here."""
        number = request.name.partition(MARK)[2]
        kinds = self._kinds.get((request.system, request.component), {})
        kind = kinds.get(int(number)) if number.isdecimal() and not request.sent else None
        if kind is None:
            return None
        return MessageView(
            request.system, request.component, False, request.name, int(number),
            kind.meter.rate(now), kind.count, now - kind.at, kind.length, (),
        )  # fmt: skip
