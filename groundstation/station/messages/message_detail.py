"""MessageDetail: the chosen message of the Messages screen, with what its fields were over the last minute."""

from __future__ import annotations

from array import array
from collections import deque
from collections.abc import Iterator, Mapping

import msgspec

from dialects.messages import Message
from groundstation.station.messages.fields import array_length, build_info, make_reader
from groundstation.station.messages.message_capture import MessageCapture
from groundstation.station.messages.message_fields import build_fields
from groundstation.station.messages.message_kind import MessageKind
from groundstation.station.messages.message_traffic import MessageTraffic, TrafficKey
from groundstation.station.view_feed import ViewFeed, ViewSource
from groundstation.views.base import ViewRequest
from groundstation.views.charts import FieldId
from groundstation.views.messages import (
    CaptureRequest,
    FieldPlot,
    MessageField,
    MessageRequest,
    MessagesRequest,
    MessageView,
)

SPAN = 60.0
"""s of which messages are kept."""

SPACING = 0.1
"""Least time between two messages that are kept, s: 600 at most."""

SAMPLES = 9
"""Bars of a spark, evenly spread over the messages that are kept."""

LEVELS = "▁▂▃▄▅▆▇█"

WATCHED_FOR = 2.0
"""s after the last request for which the messages are kept."""

TAPS = "detail"


class MessageInspector:
    """Keeps the messages of one kind, the chosen one, only while a screen requests it."""

    def __init__(self, traffic: MessageTraffic) -> None:
        self._traffic = traffic
        self._capture = MessageCapture(traffic)
        self._place: TrafficKey | None = None
        self._kept: deque[tuple[float, Message]] = deque(maxlen=round(SPAN / SPACING))
        self._asked_at = 0.0

    @property
    def sources(self) -> Mapping[type[ViewRequest], ViewSource]:
        """Request -> its source."""
        return {
            MessagesRequest: ViewSource(self._traffic.build_page, 0.5),
            MessageRequest: ViewSource(self._build, 0.25),
            CaptureRequest: ViewSource(self._capture.build_page, 0.5),
        }

    @staticmethod
    def systems(views: ViewFeed) -> frozenset[int]:
        """Return the system ids of the vehicles of which a screen shows a message."""
        return frozenset(each.system for each in views.requests(MessageRequest))

    def tick(self, now: float) -> None:
        """Forget the messages when no screen requests them any more."""
        self._capture.tick(now)
        if self._place is not None and now - self._asked_at > WATCHED_FOR:
            self._watch(None)

    def _build(self, request: MessageRequest, now: float, wall: float) -> MessageView | None:
        self._asked_at = now
        place = ((request.sent, request.system, request.component), request.name)
        if place != self._place:
            self._watch(place)
        kind = self._traffic.find(place)
        if kind is None:
            return self._traffic.unknown.build_message(request, now)
        return MessageView(
            request.system, request.component, request.sent, request.name, type(kind.newest).id, kind.rate, kind.count,
            now - kind.at, kind.length, tuple(self._fields(kind)), kind.payload, self._plot(request, kind, now),
        )  # fmt: skip

    def _watch(self, place: TrafficKey | None) -> None:
        self._place = place
        self._kept.clear()
        self._traffic.set_taps(TAPS, {} if place is None else {place: self._keep})
        kind = None if place is None else self._traffic.find(place)
        if kind is not None:
            self._kept.append((kind.at, kind.newest))

    def _keep(self, message: Message, now: float) -> None:
        if not self._kept or now - self._kept[-1][0] >= SPACING:
            self._kept.append((now, message))

    # ---- what the fields were ----

    def _fields(self, kind: MessageKind) -> Iterator[MessageField]:
        step = max(1, len(self._kept) // SAMPLES)
        chosen = [message for _, message in list(self._kept)[::-step][:SAMPLES]][::-1]
        for field in build_fields(kind.newest):
            yield msgspec.structs.replace(field, spark=_spark(type(kind.newest), field.name, chosen))

    def _plot(self, request: MessageRequest, kind: MessageKind, now: float) -> FieldPlot | None:
        """Return the last minute of the field that is asked for; of an array the item `index`."""
        message = type(kind.newest)
        if request.field not in message.fieldnames:
            return None
        length = array_length(message, request.field)
        index = max(0, min(request.index, length - 1)) if length > 0 else -1
        read = make_reader(message, request.field, index)
        if read is None:
            return None
        field = FieldId(request.system, request.component, request.sent, request.name, request.field, index)
        times, values = array("d"), array("d")
        for at, kept in self._kept:
            value = read(kept)
            if value is not None and now - at <= SPAN:
                times.append(at)
                values.append(value)
        return FieldPlot(build_info(field, message), now, times.tobytes(), values.tobytes())


def _spark(kind: type[Message], field: str, messages: list[Message]) -> str:
    """Return a bar for each message, from the lowest to the highest value; empty for flags, texts and arrays."""
    read = make_reader(kind, field, -1)
    if read is None or not messages or kind.fielddisplays_by_name.get(field) == "bitmask":
        return ""
    values = [read(message) for message in messages]
    known = [value for value in values if value is not None]
    if not known:
        return ""
    low, span = min(known), (max(known) - min(known)) or 1.0
    return "".join(" " if value is None else LEVELS[int((value - low) / span * 7.999)] for value in values)
