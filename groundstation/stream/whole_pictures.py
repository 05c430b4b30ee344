"""What decoders of screens get of a stream: the packets of pictures that are whole, and whose references are whole.

A decoder draws what is missing by guess, and its picture would count as a fresh one. Of a picture with a hole, and of
those that refer to it, it gets nothing: the newest picture grows old, and the screen says so. The next one that a
decoder can show is the next key picture.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from groundstation.stream.rtp import AccessUnit


class WholePictures:
    """Chooses packets for the ports of screens. They are numbered without a gap: for one a decoder would wait."""

    def __init__(self) -> None:
        self._showing: frozenset[int] = frozenset()
        """Ports that got each unit since a key unit."""
        self._number = 0

    def choose(self, unit: AccessUnit, screens: Iterable[int]) -> Iterator[tuple[int, bytes]]:
        """Yield ports, and what to send to each of them, for the next unit of the stream."""
        if unit.key:
            self._showing = frozenset(screens)
        elif unit.follows:
            self._showing &= frozenset(screens)
        else:
            self._showing = frozenset()
        for packet in unit.packets if self._showing else ():
            numbered = packet[:2] + self._number.to_bytes(2, "big") + packet[4:]
            self._number = (self._number + 1) & 0xFFFF
            for port in self._showing:
                yield port, numbered
