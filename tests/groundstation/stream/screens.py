"""A stream with times, and what the screens of a ground station get of it, in virtual time and without ffmpeg."""

from __future__ import annotations

from collections.abc import Iterable
from itertools import pairwise

from groundstation.stream.rtp import Depacketizer
from groundstation.stream.whole_pictures import WholePictures
from link.services.video_stream import PAYLOAD_TYPE
from tests.groundstation.stream.streams import packets, unit_of

SCREEN, OTHER = 7000, 7002
PERIOD = 1 / 15
"""s between two pictures."""
GROUP = 5
"""Pictures from a key picture to the next one."""
STEP = 0.0005
"""s between two packets."""
Sent = tuple[float, bytes]


def stream(count: int, *, first: int = 0, source: int = 7, begin: float = 0.0) -> list[Sent]:
    """Return the packets of pictures, and when they are sent."""
    sent: list[Sent] = []
    for picture in range(count):
        nals = unit_of(picture, key=picture % GROUP == 0, size=2500)
        for index, packet in enumerate(packets(nals, first + len(sent), 6000 * picture, source=source)):
            sent.append((begin + picture * PERIOD + index * STEP, packet))
    return sent


class Ground:
    """What the receiver of a stamped stream does with packets, and what its screens got."""

    def __init__(self, *screens: int) -> None:
        self.screens = screens
        self.got: dict[int, list[Sent]] = {}
        self._units, self._whole = Depacketizer(), WholePictures()

    def take(self, came: Iterable[Sent]) -> None:
        for now, packet in sorted(came, key=lambda each: each[0]):
            for unit in self._units.take(packet, now):
                for port, numbered in self._whole.choose(unit, self.screens):
                    self.got.setdefault(port, []).append((now, numbered))

    def pictures(self, screen: int = SCREEN) -> list[int]:
        """Return the numbers of the pictures that a screen got; each must be whole."""
        got = [packet for _, packet in self.got.get(screen, [])]
        numbers = [int.from_bytes(packet[2:4], "big") for packet in got]
        assert all((after - before) & 0xFFFF == 1 for before, after in pairwise(numbers))
        assert all(packet[1] & 0x7F == PAYLOAD_TYPE for packet in got)
        times = [int.from_bytes(packet[4:8], "big") // 6000 for packet in got]
        found = list(dict.fromkeys(times))
        for each in found:
            assert times.count(each) == (4 if each % GROUP == 0 else 3), "all of its packets"
        return found
