"""Frames of a TFmini-S, TFmini Plus or TF-Luna: 9 bytes at 115200 baud, a hundred times a second.

0x59 0x59, distance in cm, strength and temperature (16 bits each, the low byte first), and the sum of all bytes
before: Benewake's product manual of the TFmini-S, "Standard data output".
"""

from __future__ import annotations

import math

from vehicle.readings import Scan
from vehicle.sensors.ranging.frames import split_frames
from vehicle.sensors.ranging.settings import Beam

BAUD = 115_200
BEAM = Beam(width=2.0, near=0.1, far=4.0)
"""`far` is for black obstacles; white ones reflect to 12 m."""
HEAD, LENGTH = b"\x59\x59", 9
STRENGTH_MIN, SATURATED = 100, 0xFFFF
"""Less comes back where nothing is in range. A saturated receiver does not measure."""
INVALID = 0xFFF0
"""Distances from here on are codes: 65534 saturated, 65532 too much light of the sun."""
UNBLINDED = 0xFFFF
"""The distance that goes with a weak signal."""


class TfminiParser:
    """Finds frames in bytes."""

    def __init__(self) -> None:
        self._buffer = b""

    def feed(self, data: bytes) -> Scan | None:
        """Return the newest measurement, None before a whole frame."""
        frames, self._buffer = split_frames(self._buffer + data, HEAD, LENGTH, _is_valid)
        return parse_frame(frames[-1]) if frames else None


def _is_valid(frame: bytes) -> bool:
    return sum(frame[:-1]) & 0xFF == frame[-1]


def parse_frame(frame: bytes) -> Scan:
    """Return the scan of a frame whose sum is right."""
    distance, strength = int.from_bytes(frame[2:4], "little"), int.from_bytes(frame[4:6], "little")
    if strength == SATURATED or INVALID <= distance < UNBLINDED:
        return BEAM.scan(None)
    return BEAM.scan(math.inf if strength < STRENGTH_MIN or distance == UNBLINDED else distance / 100)
