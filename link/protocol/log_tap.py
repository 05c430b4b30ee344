"""Passes each frame that arrives, and each message of ours once, to a recorder.

Frames are recorded without their signatures, as https://mavlink.io/en/guide/message_signing.html#logging asks, and not
at all if signing refuses them.

Our own messages are numbered for the log as those of one peer that loses nothing, so that tools that count losses count
none. For the same reason a frame that several links bring is recorded once, also of a vehicle that numbers or signs
the frames of each link for itself, if the message has the vehicle's time. Left out are messages with the traits
SECRET and UNLOGGED (dialects/traits.py), and those with LOG_ONLY that arrive: notes of the program that records stand
in its log, and nobody can add any over a link.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

from dialects import codec
from dialects.codec import HEADER_V2, MAGIC_V2
from dialects.messages import MESSAGES
from dialects.traits import LOG_ONLY, SECRET, UNLOGGED
from link.protocol.frame import Frame
from link.protocol.sent_frames import SentFrames
from link.signing.signature import is_signed, strip_signature

_NOT_RECEIVED = SECRET | LOG_ONLY
_TIMED = frozenset(number for number, message in MESSAGES.items() if "time_boot_ms" in message.fieldnames)
"""Messages of which two of one content are of one moment."""

COPY_WINDOW = 1.0
"""s, at least, within which a frame from another link is a copy; twice as long at most."""
MAX_REMEMBERED = 4096
"""Frames in half of the memory of copies."""


class _Copies:
    """Finds frames that another link has brought before."""

    def __init__(self) -> None:
        self._links: dict[bytes, int] = {}
        self._older: dict[bytes, int] = {}
        self._since = 0.0

    def is_copy(self, raw: bytes, link: int, now: float) -> bool:
        """Return whether another link has brought this frame, or its content, just before; else remember it."""
        age = now - self._since
        if age >= COPY_WINDOW or len(self._links) >= MAX_REMEMBERED:
            older = self._links if age < 2 * COPY_WINDOW else {}
            self._links, self._older, self._since = {}, older, now
        first = self._links.get(raw)
        first = self._older.get(raw, link) if first is None else first
        if first != link:
            return True
        self._links[raw] = link
        return False


def _content(message_id: int, raw: bytes) -> bytes:
    """Return what a copy over another link has as well: without number, checksum and signature if it has a time."""
    if raw[0] != MAGIC_V2 or message_id not in _TIMED:
        return raw
    return raw[5 : HEADER_V2 + raw[1]]


class LogTap:
    """Passes frames and their times to `add`.

    `unsent`: also our own messages that no link takes. `sent`: frames of ours, which are not recorded again when they
    come back. `signatures`: pass frames with their signatures, which no log keeps.
    """

    def __init__(
        self,
        add: Callable[[float, Sequence[bytes]], None],
        *,
        system: int,
        component: int,
        unsent: bool = True,
        sent: SentFrames | None = None,
        signatures: bool = False,
    ) -> None:
        self.unsent = unsent
        self._signatures = signatures
        self._add = add
        self._ids = (system, component)
        self._sent = sent or SentFrames()
        self._copies = _Copies()
        self._sequence = 0

    def record_received(self, frames: Sequence[Frame], link: int, now: float) -> None:
        """Record complete frames of any sender. `link` is the index of the link that brought them."""
        kept = [
            raw
            for number, _, _, _, raw in frames
            if number not in _NOT_RECEIVED
            and not self._copies.is_copy(_content(number, raw), link, now)
            and raw not in self._sent
        ]
        if kept:
            keep = self._signatures
            self._add(now, kept if keep else [strip_signature(raw) if is_signed(raw) else raw for raw in kept])

    def record_sent(self, message_id: int, payload: bytes, now: float) -> None:
        """Record one of our own messages, or a note of ours."""
        if message_id not in UNLOGGED:
            self._add(now, (codec.frame(message_id, payload, self._sequence, *self._ids),))
            self._sequence = (self._sequence + 1) & 0xFF
