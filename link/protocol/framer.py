"""Splits bytes into frames: checks length and checksum, resynchronises byte by byte, counts errors.

A frame counts only when its id is in the dialect and its checksum is right. Anything else moves the search on by ONE
byte, so that a stray start byte costs nothing (pymavlink discards the whole claimed length: 12 frames, 0.65 s at 20
Hz). Received bytes never raise. Payloads are not decoded here. Format: https://mavlink.io/en/guide/serialization.html.

Operations wanted: return each complete frame of a read at once, wait for one that is cut in two, and find the next
frame behind damage. Most reads hold whole frames, so `_scan` unpacks a header, looks up its id and computes one
checksum, without another call; `_slow` has every other case.

Worst case: each byte is a start byte. Each position is then tried as a frame of 280 bytes at most, so the time grows
with the bytes and not with their square. On a stream a forged header claims bytes that never come: PARTIAL_DEADLINE
ends the wait, and no more than one incomplete frame is kept.

Why not simpler: a jump over the claimed length loses the frames inside it, and a state machine that is fed byte by
byte needs a call of Python for each.
"""

from __future__ import annotations

import math
import re
import struct
from enum import Enum, auto

from fastcrc.crc16 import mcrf4xx

from dialects.codec import (
    BASE_SIZE,
    CRC_EXTRA,
    CRC_SIZE,
    HEADER_V1,
    HEADER_V2,
    INCOMPAT_SIGNED,
    MAGIC_V1,
    MAGIC_V2,
    SIGNATURE_SIZE,
)
from link.protocol.checksum import START, STEP, TWO_STEPS
from link.protocol.failed_frame import FailedFrames
from link.protocol.frame import Frame, FramerCounts, UnknownKey, read_header

PARTIAL_DEADLINE = 0.1
"""s to wait for the rest of a frame on a stream. Longer than the longest frame takes at 57600 baud (280 bytes, 49 ms),
shorter than the vehicle waits for a demand (0.45 s): a forged header must not hide the frames behind it."""

_SHORTEST = HEADER_V2 + CRC_SIZE
_TRAILER = CRC_SIZE + SIGNATURE_SIZE
_MAGIC = re.compile(b"[\xfd\xfe]")
_read_head = struct.Struct("<BBBxBBBHB").unpack_from
"""Start byte, length, incompatibility flags, sequence, system, component, the lower and the upper part of the id."""


class _Missing(Enum):
    """What is missing at a position where there is no frame, but where one may follow."""

    MAGIC = auto()
    """The start byte."""
    BYTES = auto()
    """The end, which may still arrive."""


class Framer:
    """Finds the frames in one sender's bytes.

    With `stream=False` each feed() is one datagram, and no frame continues in the next. With `stream=True` bytes are
    kept until a frame is complete, but no longer than PARTIAL_DEADLINE. With `unknown=True`, for routers, frames with
    ids outside the dialect are returned as well: such a frame must start where a valid frame ended, and end where the
    bytes end or another frame starts.
    """

    def __init__(self, *, stream: bool, unknown: bool = False) -> None:
        self.counts = FramerCounts()
        self._stream = stream
        self._unknown = unknown
        self._at_border = True
        """The buffer starts where a frame may start: no noise before it."""
        self._buffer = b""
        self._waiting_since: float | None = None
        self._needed = 0
        """Bytes that the partial frame at the start of the buffer has at least; 0: not known."""
        self._failed = FailedFrames(self.counts)

    def feed(self, data: bytes, now: float) -> list[Frame]:
        """Return all frames that are complete now. `now` in s, monotonic.

        The usual case comes first: a datagram that is exactly one unsigned MAVLink 2 frame.
        """
        if self._stream:
            return self._feed_stream(data, now)
        size = len(data)
        if size >= _SHORTEST:
            magic, length, flags, sequence, system, component, message_id, upper = _read_head(data)
            if upper:
                message_id |= upper << 16
            if length + _SHORTEST == size and magic == MAGIC_V2 and not flags:
                extra = CRC_EXTRA.get(message_id)
                if extra is not None:
                    low, high = data[-2], data[-1]
                    if mcrf4xx(data, START) == high ^ STEP[low ^ high] ^ TWO_STEPS[low ^ extra[0]]:
                        self.counts.frames += 1
                        return [(message_id, system, component, sequence, data)]
        return self._feed_unusual(data)

    def expire(self, now: float) -> list[Frame]:
        """Give up an overdue partial frame and search behind its first byte; call it also in silence."""
        frames: list[Frame] = []
        while self._waiting_since is not None and now - self._waiting_since >= PARTIAL_DEADLINE:
            self._skip_first_byte()
            frames = self._take(now)  # if there are any, what is left behind them waits from now on
            if not frames and self._waiting_since is not None:
                self._waiting_since = -math.inf  # the bytes behind the first one have waited as long
        return frames

    def _feed_unusual(self, data: bytes) -> list[Frame]:
        """Handle a datagram; one that is a signed frame, or a frame with an unknown id, is not searched for others."""
        header = read_header(data) if len(data) >= _SHORTEST and data[0] == MAGIC_V2 else None
        if header is not None and header.size == len(data):
            message_id, system, component, sequence, size = header
            extra = CRC_EXTRA.get(message_id)
            if extra is None and not self._unknown:
                self.counts.unknown += 1
                self.counts.add_unknown((system, component, message_id), 1, size)
                return []
            if extra is not None and data[2]:  # signed, so that it has the bytes of a trailer
                claimed = data[-_TRAILER] | data[1 - _TRAILER] << 8
                if mcrf4xx(data[1:-_TRAILER] + extra) == claimed:
                    self.counts.frames += 1
                    return [(message_id, system, component, sequence, data)]
        return self._scan(data, final=True)[0]

    def _feed_stream(self, data: bytes, now: float) -> list[Frame]:
        """Handle the bytes of one read; most of them only add to a partial frame of which the length is known."""
        since = self._waiting_since
        if since is not None and now - since >= PARTIAL_DEADLINE:
            frames = self.expire(now)
            self._buffer += data
            return frames + self._take(now)
        self._buffer += data
        return self._take(now) if len(self._buffer) >= self._needed else []

    def _skip_first_byte(self) -> None:
        self._buffer = self._buffer[1:]
        self._at_border = False
        self._failed.drop()
        self.counts.resync_bytes += 1

    def _take(self, now: float) -> list[Frame]:
        self._needed = 0
        frames, used = self._scan(self._buffer, final=False)
        if used:
            self._buffer = self._buffer[used:]
            self._failed.shift(used)
        if not self._buffer:
            self._waiting_since = None
        elif used or self._waiting_since is None:
            self._waiting_since = now
        return frames

    def _scan(self, data: bytes, *, final: bool) -> tuple[list[Frame], int]:  # noqa: C901 - calls cost more here
        """Return the frames in `data` and how many bytes are used up. `final`: no more bytes will come.

        The hot path of all reception: for a valid unsigned MAVLink 2 frame the only call is the checksum's. _frame_at
        covers all other cases.
        """
        frames: list[Frame] = []
        failed = self._failed
        position, size = 0, len(data)
        border = 0 if self._at_border else -1
        while position < size:
            if position + _SHORTEST <= size:
                magic, length, flags, sequence, system, component, message_id, upper = _read_head(data, position)
                if upper:
                    message_id |= upper << 16
                extra = CRC_EXTRA.get(message_id)
                if extra is not None and magic == MAGIC_V2 and not flags:
                    end = position + length + _SHORTEST
                    if end <= size:
                        raw = data[position:end]
                        low, high = raw[-2], raw[-1]
                        if mcrf4xx(raw, START) == high ^ STEP[low ^ high] ^ TWO_STEPS[low ^ extra[0]]:
                            if failed.newest is not None:
                                failed.settle(position)
                            frames.append((message_id, system, component, sequence, raw))
                            position = border = end
                            continue
                    elif not final:
                        self._needed = end - position
                        break
            elif not final and data[position] == MAGIC_V2:
                self._needed = _SHORTEST
                break
            after, border = self._slow(data, position, size, frames, border)
            if after == position:
                if not final:
                    break  # the rest of the frame may still arrive
                self.counts.resync_bytes += 1
                after += 1
            position = after
        self.counts.frames += len(frames)
        if not final:
            self._at_border = border == position
            return frames, position
        failed.settle(size)
        return frames, position

    def _slow(self, data: bytes, position: int, size: int, frames: list[Frame], border: int) -> tuple[int, int]:
        """Handle any case at `position`; return where to continue and where the last frame ended.

        The first is `position` itself while the end of a frame has not arrived.
        """
        found = self._frame_at(data, position, size)
        if found is None and position == border and self._unknown:
            found = self._unknown_at(data, position, size)
        if isinstance(found, tuple):
            self._failed.settle(position)
            frames.append(found)
            end = position + len(found[4])
            return end, end
        if found is _Missing.BYTES:
            return position, border
        if found is _Missing.MAGIC:
            return self._next_magic(data, position, size), border
        self.counts.resync_bytes += 1
        return position + 1, border

    def _unknown_at(self, data: bytes, start: int, size: int) -> Frame | _Missing | None:
        """Return the frame with an id outside the dialect at `start`, judged by its boundaries alone."""
        header = read_header(data, start)
        if header is None or header.message_id in CRC_EXTRA or not header.system:
            return None
        end = start + header.size
        if end > size:
            return _Missing.BYTES
        if end < size and data[end] not in (MAGIC_V1, MAGIC_V2):
            return None
        self.counts.unknown += 1
        self.counts.frames -= 1  # _scan counts it among the verified frames
        return (header.message_id, header.system, header.component, header.sequence, data[start:end])

    def _next_magic(self, data: bytes, position: int, size: int) -> int:
        match = _MAGIC.search(data, position)
        end = match.start() if match else size
        self.counts.resync_bytes += end - position
        return end

    def _frame_at(self, data: bytes, start: int, size: int) -> Frame | _Missing | None:
        """Return the frame at `start`, or what is missing; None: what starts there is no frame."""
        if data[start] != MAGIC_V2:
            return self._frame_v1(data, start, size) if data[start] == MAGIC_V1 else _Missing.MAGIC
        if size - start < HEADER_V2 + CRC_SIZE:
            return _Missing.BYTES
        length, flags, _, sequence, system, component, low, middle, high = data[start + 1 : start + HEADER_V2]
        message_id = low | middle << 8 | high << 16
        crc_at = start + HEADER_V2 + length
        end = crc_at + CRC_SIZE + (SIGNATURE_SIZE if flags else 0)
        extra = CRC_EXTRA.get(message_id)
        if flags > INCOMPAT_SIGNED or extra is None:
            self._add_foreign(start, end, flags, (system, component, message_id))
            return None
        if end > size:
            return _Missing.BYTES
        if mcrf4xx(data[start + 1 : crc_at] + extra) != data[crc_at] | data[crc_at + 1] << 8:
            self._failed.add_bad_crc(start, end, message_id)
            return None
        return (message_id, system, component, sequence, data[start:end])

    def _add_foreign(self, start: int, end: int, flags: int, key: UnknownKey) -> None:
        """Handle unknown incompatibility flags (the frame must be dropped), or an id outside the dialect."""
        if flags > INCOMPAT_SIGNED:
            self._failed.add_refused(start)
        else:
            self._failed.add_unknown(start, end, key)

    def _frame_v1(self, data: bytes, start: int, size: int) -> Frame | _Missing | None:
        if size - start < HEADER_V1 + CRC_SIZE:
            return _Missing.BYTES
        length, sequence, system, component, message_id = data[start + 1 : start + HEADER_V1]
        crc_at = start + HEADER_V1 + length
        end = crc_at + CRC_SIZE
        size_in_dialect = BASE_SIZE.get(message_id)
        if size_in_dialect is None:
            self._failed.add_unknown(start, end, (system, component, message_id))
            return None
        if size_in_dialect != length:
            self._failed.add_refused(start)
            return None
        if end > size:
            return _Missing.BYTES
        if mcrf4xx(data[start + 1 : crc_at] + CRC_EXTRA[message_id]) != data[crc_at] | data[crc_at + 1] << 8:
            self._failed.add_bad_crc(start, end, message_id)
            return None
        return (message_id, system, component, sequence, data[start:end])
