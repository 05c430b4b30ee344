"""MessageCapture: every message of one kind as lines of a CSV file, while a screen writes one."""

from __future__ import annotations

from collections import deque
from typing import Any

from dialects.messages import Message
from dialects.printable import printable
from groundstation.formats.csv_row import csv_row
from groundstation.station.messages.fields import array_length
from groundstation.station.messages.message_fields import field_value
from groundstation.station.messages.message_traffic import MessageTraffic, TrafficKey
from groundstation.views.messages import CapturePage, CaptureRequest

KEPT = 4000
"""Messages that wait for the screen: 4 s at 1000 messages/s, eight periods of its view."""

PAGE = 100_000
"""Characters of one page: less than half a packet."""

WATCHED_FOR = 3.0
"""s after the last request for which messages are kept."""

TAPS = "capture"


class MessageCapture:
    """Messages of one kind, numbered from 1 in the order of their arrival."""

    def __init__(self, traffic: MessageTraffic) -> None:
        self._traffic = traffic
        self._place: TrafficKey | None = None
        self._kept: deque[tuple[int, float, Message]] = deque(maxlen=KEPT)
        self._newest = 0
        self._asked_at = 0.0

    def build_page(self, request: CaptureRequest, now: float, wall: float) -> CapturePage | None:
        """Return the lines of the messages after `request.after`, oldest first; None without any."""
        self._asked_at = now
        place = ((request.sent, request.system, request.component), request.name)
        if place != self._place:
            self._watch(place)
        after = min(request.after, self._newest)
        new = [each for each in self._kept if each[0] > after]
        if not new:
            return None
        lines = self._lines(new, now, wall)
        lost = new[0][0] - after - 1
        return CapturePage(csv_row(_titles(type(new[0][2]))), lines, new[len(lines) - 1][0], request.after, lost)

    def _lines(self, new: list[tuple[int, float, Message]], now: float, wall: float) -> tuple[str, ...]:
        """Return the lines that fit in a page."""
        lines: list[str] = []
        size = 0
        for _, at, message in new:
            lines.append(csv_row([f"{wall - (now - at):.6f}", *_values(message)]))
            size += len(lines[-1])
            if size >= PAGE:
                break
        return tuple(lines)

    def tick(self, now: float) -> None:
        """Keep nothing more when no screen writes any more."""
        if self._place is not None and now - self._asked_at > WATCHED_FOR:
            self._watch(None)

    def _watch(self, place: TrafficKey | None) -> None:
        self._place = place
        self._kept.clear()
        self._traffic.set_taps(TAPS, {} if place is None else {place: self._keep})

    def _keep(self, message: Message, now: float) -> None:
        self._newest += 1
        self._kept.append((self._newest, now, message))


def _titles(kind: type[Message]) -> list[str]:
    titles = ["time"]
    for name in kind.fieldnames:
        length = array_length(kind, name)
        titles += [f"{name}[{index}]" for index in range(length)] if length > 0 else [name]
    return titles


def _values(message: Message) -> list[Any]:
    values: list[Any] = []
    for name in type(message).fieldnames:
        value = field_value(message, name)
        if isinstance(value, (list, tuple)):
            values += value
        else:
            values.append(_text(value) if isinstance(value, (str, bytes)) else value)
    return values


def _text(value: str | bytes) -> str:
    """Return text without control characters."""
    if isinstance(value, bytes):
        value = value.split(b"\0", 1)[0].decode("utf-8", "replace")
    return printable(value)
