"""Checksum of a received MAVLink 2 frame, with one call for the whole frame and no copy of its bytes.

The checksum (CRC-16/MCRF4XX, https://mavlink.io/en/guide/serialization.html#checksum) is that of the frame without its
start byte, followed by CRC_EXTRA, which is not on the wire. Two properties of every CRC save the copy of the bytes. A
step of the register can be undone: from START it comes to the prescribed 0xFFFF after the start byte. And it is linear:
a byte `extra` in the place of the first checksum byte `low` changes the register by a value that depends on
`low ^ extra` alone. So these are equal for a right frame, and for no other:

    mcrf4xx(frame, START)   and   high ^ STEP[low ^ high] ^ TWO_STEPS[low ^ extra]

where `low` and `high` are its last two bytes, and a signature is not part of it. This stands in line where frames are
found, because a call costs as much as the checksum.
"""

from __future__ import annotations

from fastcrc.crc16 import mcrf4xx

START = 0x3085
"""Register that the start byte 0xFD turns into 0xFFFF."""

STEP: tuple[int, ...] = tuple(mcrf4xx(bytes([byte]), 0) for byte in range(256))
"""Register after one byte, from 0."""

TWO_STEPS: tuple[int, ...] = tuple(step >> 8 ^ STEP[step & 0xFF] for step in STEP)
"""Register after that byte and a zero, from 0."""
