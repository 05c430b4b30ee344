"""Packets of an LD06, LD19 or STL-19P: 12 points in 47 bytes at 230400 baud, ten turns a second, clockwise.

0x54 0x2C, speed (degrees/s), first angle (0.01 degrees), 12 points of distance (mm) and intensity (8 bits), last angle,
time (ms), all with the low byte first, and a CRC of 8 bits: LDROBOT's development manual of the LD06.
"""

from __future__ import annotations

import math
import struct

from vehicle.readings import Cone, Scan
from vehicle.sensors.ranging.frames import split_frames

BAUD = 230_400
HEAD, LENGTH, POINTS = b"\x54\x2c", 47, 12
PACKET = struct.Struct("<2xHH" + POINTS * "HB" + "HHB")
POLYNOMIAL = 0x4D
SECTORS = 72
"""Of 5 degrees: the nearest point in each counts."""
FAR = 8.0
"""m to which it sees dark obstacles, too."""
NEAR = 0.02
STEP = math.tau / SECTORS


def _crc_table() -> bytes:
    table = []
    for value in range(256):
        for _ in range(8):
            value = (value << 1 ^ (POLYNOMIAL if value & 0x80 else 0)) & 0xFF
        table.append(value)
    return bytes(table)


CRC_TABLE = _crc_table()


def crc8(data: bytes) -> int:
    """Return the CRC of the bytes before it."""
    crc = 0
    for value in data:
        crc = CRC_TABLE[crc ^ value]
    return crc


class Ld06Parser:
    """Collects the points of a turn."""

    def __init__(self) -> None:
        self._buffer = b""
        self._nearest: dict[int, float] = {}
        """Sector -> m of its nearest point; infinite: looked at without an echo."""
        self._angle = 0.0

    def feed(self, data: bytes) -> Scan | None:
        """Return the newest whole turn, None before its end."""
        packets, self._buffer = split_frames(self._buffer + data, HEAD, LENGTH, _is_valid)
        newest: Scan | None = None
        for packet in packets:
            newest = self._add(packet) or newest
        return newest

    def _add(self, packet: bytes) -> Scan | None:
        _, first, *points, last, _, _ = PACKET.unpack(packet)
        begin, span = first / 100, (last - first) / 100 % 360
        turn = self._finish() if begin < self._angle else None
        self._angle = begin
        for index in range(POINTS):
            distance, intensity = points[2 * index], points[2 * index + 1]
            sector = round((begin + span * index / (POINTS - 1)) / 360 * SECTORS) % SECTORS
            metres = distance / 1000 if distance and intensity else math.inf
            self._nearest[sector] = min(self._nearest.get(sector, math.inf), metres)
        return turn

    def _finish(self) -> Scan:
        """Return the scan of the turn. A turn without any echo has measured nothing: the sensor may be covered."""
        nearest, self._nearest = self._nearest, {}
        blind = all(math.isinf(each) for each in nearest.values())
        return tuple(
            Cone(sector * STEP, STEP / 2, None if blind else _measured(nearest.get(sector)), FAR, central=True)
            for sector in range(SECTORS)
        )


def _is_valid(packet: bytes) -> bool:
    return crc8(packet[:-1]) == packet[-1]


def _measured(distance: float | None) -> float | None:
    if distance is None:
        return None
    return 0.0 if distance < NEAR else min(distance, FAR)


UNMEASURED: Scan = tuple(Cone(sector * STEP, STEP / 2, None, FAR, central=True) for sector in range(SECTORS))
"""Where it looks."""
