"""STATUSTEXTs in chunks: joined as bytes, because a chunk may end inside a character; a lost chunk leaves a gap.

https://mavlink.io/en/messages/common.html#STATUSTEXT: `id` is 0 for a text in one message, the last chunk is the one
with a zero byte.
"""

from __future__ import annotations

import codecs
from collections.abc import Iterator
from typing import Any

import msgspec

from dialects.messages import StatusText, decode_bytes

CHUNK = 50
"""Bytes of text in one STATUSTEXT (common.xml)."""

MAX_CHUNKS = 8
"""Chunks joined to one text; longer texts are cut."""

MAX_OPEN = 8
"""Incomplete texts that are kept; beyond that the oldest is given up."""

CHUNK_TIMEOUT = 2.0
"""s after which an incomplete text is shown without its missing chunks."""

GAP = "[...]"
"""In place of lost chunks."""

_CONTINUATION = bytes(range(0x80, 0xC0))
"""Bytes that continue a character of UTF-8."""

TextKey = tuple[int, int, int]
"""System id, component id and `id` of a text: two components may use the same `id`."""


class ChunkedText(msgspec.Struct):
    """A text, as far as it has arrived. `started` is when its first chunk did."""

    key: TextKey
    started: float
    severity: int
    parts: dict[int, bytes] = msgspec.field(default_factory=dict)
    last: int | None = None
    """Number of the last chunk; None until it has arrived."""
    made: Any = None
    """What the caller has made of it so far, for the chunks that follow."""

    @property
    def complete(self) -> bool:
        """Whether all chunks have arrived."""
        return self.last is not None and len(self.parts) > self.last

    @property
    def text(self) -> str:
        """The text, printable, with GAP where chunks are missing."""
        pieces = self._pieces()
        if len(pieces) == 1:
            return decode_bytes(pieces[0] or b"")
        return " ".join(GAP if piece is None else decode_bytes(_whole(piece)).strip() for piece in pieces)

    def _pieces(self) -> list[bytes | None]:
        """Return what has arrived without a gap, and None for each gap."""
        pieces: list[bytes | None] = []
        for number in range((max(self.parts) if self.last is None else self.last) + 1):
            part = self.parts.get(number)
            before = pieces[-1] if pieces else None
            if part is None:
                if not pieces or before is not None:
                    pieces.append(None)
            elif before is None:
                pieces.append(part)
            else:
                pieces[-1] = before + part
        return pieces if self.last is not None else [*pieces, None]


class TextJoiner:
    """Joins the chunks of all sources. Whoever has one calls `pop_overdue` now and then, or loses texts with a gap."""

    def __init__(self) -> None:
        self._open: dict[TextKey, ChunkedText] = {}
        self._given_up: list[ChunkedText] = []

    def add(self, message: StatusText, system: int, component: int, now: float) -> ChunkedText:
        """Handle a message; return the text that it belongs to, which may be complete now."""
        number, raw = int(message.chunk_seq), message._text_raw.split(b"\0", 1)[0]
        key = (system, component, int(message.id))
        if message.id == 0:
            return ChunkedText(key, now, int(message.severity), {0: raw}, 0)
        found = self._open.get(key)
        if found is not None and found.parts.get(number, raw) != raw:  # another text with the same id
            self._given_up.append(self._open.pop(key))
            found = None
        if found is None:
            found = self._open[key] = ChunkedText(key, now, int(message.severity))
        if number < MAX_CHUNKS:
            found.parts[number] = raw
        if len(raw) < CHUNK or number >= MAX_CHUNKS - 1:
            found.last = min(number, MAX_CHUNKS - 1)
        if found.complete:
            del self._open[key]
        elif len(self._open) > MAX_OPEN:
            self._given_up.append(self._open.pop(next(iter(self._open))))
        return found

    def pop_overdue(self, now: float) -> Iterator[ChunkedText]:
        """Yield the texts whose missing chunks come no more, oldest first, and forget them."""
        given_up, self._given_up = self._given_up, []
        overdue = [key for key, text in self._open.items() if now - text.started > CHUNK_TIMEOUT]
        for text in (*given_up, *[self._open.pop(key) for key in overdue]):
            if text.parts:
                yield text


def _whole(piece: bytes) -> bytes:
    """Return the bytes beside a gap without the parts of a character that was cut by it."""
    piece = piece.lstrip(_CONTINUATION)
    return codecs.getincrementaldecoder("utf-8")("replace").decode(piece).encode()
