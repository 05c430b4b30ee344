"""H.264 out of RTP (RFC 6184, packetization mode 1): whole access units in Annex B, as files and decoders have them.

Time is an argument. A unit of which a packet is missing is dropped; copies of a packet that was taken are, too.
"""

from __future__ import annotations

from collections.abc import Iterator

import msgspec

from link.services.video_stream import MARKER, PAYLOAD_TYPE

HEADER = 12
"""Bytes of a header of RTP."""
START = b"\0\0\0\1"
"""Before each NAL unit in Annex B."""
MAX_UNIT = 4 << 20
"""Bytes of a picture; a larger one is dropped."""
WAIT = 0.05
"""s that later packets wait for one that they have overtaken."""
MAX_WAITING = 64
"""Packets that wait at most."""
JUMP = 1000
"""Numbers by which a packet is so far away that its sender has started again."""
_STAP_A, _FU_A = 24, 28
_KEY, _PARAMETERS, _DELIMITER = 5, 7, 9
"""NAL units of a picture that needs no other one, of the parameters before it, and of what may be before those."""


class AccessUnit(msgspec.Struct, frozen=True):
    """One coded picture."""

    data: bytes
    key: bool
    """It needs no earlier one: decoders begin with it."""
    follows: bool
    """Nothing is missing between the unit before and this one."""
    packets: tuple[bytes, ...]
    """Those in which it came, in order."""


class Depacketizer:
    """Takes packets of one stream; a sender that is new begins a new one."""

    def __init__(self) -> None:
        self._source: bytes | None = None
        self._next: int | None = None
        self._waiting: dict[int, bytes] = {}
        self._waits_since = 0.0
        self._unit = _Unit()

    def take(self, packet: bytes, now: float) -> Iterator[AccessUnit]:
        """Yield the units that are whole with this packet."""
        if not is_video(packet):
            return
        number, source = int.from_bytes(packet[2:4], "big"), packet[8:12]
        ahead = 0 if self._next is None else (number - self._next) & 0xFFFF
        if source != self._source or JUMP < ahead < 0x10000 - JUMP:
            self._source, self._next, self._waiting, self._unit = source, number, {}, _Unit()
            ahead = 0
        if ahead >= 0x8000:
            return  # late: it was given up
        if not self._waiting:
            self._waits_since = now
        self._waiting[number] = packet
        yield from self._read(now)

    def _read(self, now: float) -> Iterator[AccessUnit]:
        while self._waiting and self._next is not None:
            if self._next not in self._waiting:
                if now - self._waits_since < WAIT and len(self._waiting) < MAX_WAITING:
                    return
                self._skip(self._next)
            unit = self._unit.take(self._waiting.pop(self._next))
            self._next, self._waits_since = (self._next + 1) & 0xFFFF, now
            if unit is not None:
                yield unit

    def _skip(self, missing: int) -> None:
        """Go on with the first packet that waits."""
        lost = min((number - missing) & 0xFFFF for number in self._waiting)
        self._unit.lose(lost)
        self._next = (missing + lost) & 0xFFFF


class _Unit:
    """The unit that is being put together."""

    def __init__(self) -> None:
        self._parts: list[bytes] = []
        self._packets: list[bytes] = []
        self._kinds: set[int] = set()
        self._size = self._lost = 0
        self._time = b""
        self._open = False
        """A packet of it has come."""
        self._broken = True
        """Of the first unit the begin may be missing."""
        self._follows = False

    def lose(self, count: int) -> None:
        """Note that packets are missing."""
        self._lost, self._broken, self._follows = count, True, False

    def take(self, packet: bytes) -> AccessUnit | None:
        """Take the next packet. Returns the unit that ends with it, if it is whole."""
        payload = _payload(packet)
        if packet[4:8] != self._time and self._open:
            self._clear()  # its last packet, which has the marker, is missing
            self._broken, self._follows = self._lost > 1, False
        if not self._open and _begins(payload):
            self._broken = False  # what is missing belongs to the unit before
        self._time, self._open, self._lost = packet[4:8], True, 0
        self._size += len(packet)
        if self._size > MAX_UNIT:
            self._broken = True
        self._packets.append(packet)
        self._add(payload)
        if self._broken:
            self._parts, self._packets = [], []
        return self._end() if packet[1] & MARKER else None

    def _end(self) -> AccessUnit | None:
        found = None
        if self._parts:
            key = self._kinds >= {_KEY, _PARAMETERS}
            found = AccessUnit(b"".join(self._parts), key, self._follows, tuple(self._packets))
        self._clear()
        self._follows = found is not None
        return found

    def _clear(self) -> None:
        self._parts, self._packets, self._kinds, self._size = [], [], set(), 0
        self._open = self._broken = False

    def _add(self, payload: bytes) -> None:
        kind = payload[0] & 0x1F if payload else 0
        if kind == _FU_A and len(payload) > 2:
            begins, nal = payload[1] & 0x80, bytes([payload[0] & 0xE0 | payload[1] & 0x1F])
            if begins:
                self._append(START + nal + payload[2:], nal[0])
            elif self._parts:
                self._parts.append(payload[2:])
            else:
                self._broken = True
        elif kind == _STAP_A:
            at = 1
            while at + 2 < len(payload):
                size = int.from_bytes(payload[at : at + 2], "big")
                self._append(START + payload[at + 2 : at + 2 + size], payload[at + 2])
                at += 2 + size
        elif 0 < kind < _STAP_A:
            self._append(START + payload, payload[0])
        else:
            self._broken = True

    def _append(self, data: bytes, first: int) -> None:
        self._parts.append(data)
        self._kinds.add(first & 0x1F)


def is_video(packet: bytes) -> bool:
    """Return whether it is RTP with our payload; its reports (RTCP) are not."""
    return is_rtp(packet, PAYLOAD_TYPE)


def is_rtp(packet: bytes, payload_type: int) -> bool:
    """Return whether it is RTP with this payload."""
    return len(packet) > HEADER and packet[0] >> 6 == 2 and packet[1] & 0x7F == payload_type


def _begins(payload: bytes) -> bool:
    """Return whether a unit begins with it: parameters and delimiters are before all slices."""
    at = 3 if payload and payload[0] & 0x1F == _STAP_A else 0
    return len(payload) > at and payload[at] & 0x1F in (_PARAMETERS, _DELIMITER)


def _payload(packet: bytes) -> bytes:
    """Return what is behind the header, its sources and its extension, without padding."""
    at = HEADER + 4 * (packet[0] & 0x0F)
    if packet[0] & 0x10:
        at += 4 + 4 * int.from_bytes(packet[at + 2 : at + 4], "big")
    end = len(packet) - (packet[-1] if packet[0] & 0x20 else 0)
    return packet[at:end]
