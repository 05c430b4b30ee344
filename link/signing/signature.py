"""The signature of one frame: link id, timestamp and 48 bits of SHA-256 behind the checksum.

https://mavlink.io/en/guide/message_signing.html
"""

from __future__ import annotations

import hashlib
from hmac import compare_digest

from fastcrc.crc16 import mcrf4xx

from dialects.codec import CRC_EXTRA, CRC_SIZE, INCOMPAT_SIGNED, MAGIC_V2, SIGNATURE_SIZE

DIGEST_SIZE = 6
"""Bytes of SHA-256 in a frame."""
STAMP_MAX = (1 << 48) - 1
"""Largest timestamp: in the year 2104."""


class SecretHash:
    """SHA-256 that has taken a secret already, so that each frame costs one block less."""

    __slots__ = ("_begun",)

    def __init__(self, secret: bytes) -> None:
        self._begun = hashlib.sha256(secret)

    def sign(self, frame: bytes, link_id: int, stamp: int) -> bytes:
        """Return a frame with its signature. `frame` is whole, with the flag for signed frames in its checksum."""
        signed = frame + bytes((link_id,)) + stamp.to_bytes(6, "little")
        digest = self._begun.copy()
        digest.update(signed)
        return signed + digest.digest()[:DIGEST_SIZE]

    def matches(self, frame: bytes) -> bool:
        """Return whether a whole signed frame was signed with this secret, in a time that tells nothing of it."""
        digest = self._begun.copy()
        digest.update(frame[:-DIGEST_SIZE])
        return compare_digest(digest.digest()[:DIGEST_SIZE], frame[-DIGEST_SIZE:])


def is_signed(frame: bytes) -> bool:
    """Return whether a whole frame, as received, carries a signature."""
    return frame[0] == MAGIC_V2 and bool(frame[2] & INCOMPAT_SIGNED)


def link_and_stamp(frame: bytes) -> tuple[int, int]:
    """Return link id and timestamp (10 us since 2015-01-01) of a signed frame."""
    return frame[-SIGNATURE_SIZE], int.from_bytes(frame[1 - SIGNATURE_SIZE : -DIGEST_SIZE], "little")


def strip_signature(frame: bytes) -> bytes:
    """Return a signed frame of a known id as an unsigned one, as the specification asks for logs."""
    message_id = int.from_bytes(frame[7:10], "little")
    body = bytearray(frame[1 : -SIGNATURE_SIZE - CRC_SIZE])
    body[1] &= ~INCOMPAT_SIGNED
    return frame[:1] + body + mcrf4xx(bytes(body) + CRC_EXTRA[message_id]).to_bytes(CRC_SIZE, "little")
