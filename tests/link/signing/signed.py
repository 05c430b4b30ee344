"""Keys, clocks and signed frames for the tests of signing."""

from __future__ import annotations

import hashlib

from dialects import codec
from dialects.messages import CommandLong, Heartbeat, Message
from link.core import Outgoing
from link.protocol.channel import Channel
from link.protocol.signing_guard import SigningGuard, SigningPolicy
from link.signing.clock import to_stamp
from link.signing.keys import KeyRing, SigningKey
from link.signing.role import SigningRole
from link.signing.signature import SecretHash
from link.signing.signing import Signing, SigningMemory

NOON = 1_795_000_000.0
"""A moment in November 2026, Unix time in s, at which the monotonic clock of the tests is 0."""
NOW = to_stamp(NOON)
"""The same as a timestamp."""
DAY = 86_400 * 100_000
"""Timestamps a day."""
DRIVER = SigningKey("laptop", SigningRole.SET_UP, hashlib.sha256(b"the laptop's").digest())
WATCHER = SigningKey("tablet", SigningRole.WATCH, hashlib.sha256(b"the tablet's").digest())
STRANGER = SigningKey("laptop", SigningRole.SET_UP, hashlib.sha256(b"a stranger's").digest())
SIGNED_ONLY = SigningPolicy(unsigned=None)
HERE, THERE = ("192.0.2.1", 5001), ("192.0.2.2", 5002)
ARM = CommandLong(1, 1, 400, 0, 1, 0, 0, 0, 0, 0, 0)
DISARM = CommandLong(1, 1, 400, 0, 0, 0, 0, 0, 0, 0, 0)
HEARTBEAT = Heartbeat(6, 8, 0, 0, 4, 3)


def signed(
    message: Message = HEARTBEAT,
    key: SigningKey = DRIVER,
    stamp: int = NOW,
    *,
    link_id: int = 0,
    sequence: int = 0,
    ids: tuple[int, int] = (255, 190),
) -> bytes:
    """A frame of a ground station, signed by our encoder, which test_interop.py holds to pymavlink."""
    frame = codec.frame_to_sign(type(message).id, codec.encode_payload(message), sequence, *ids)
    return SecretHash(key.secret).sign(frame, link_id, stamp)


def keep(*keys: SigningKey, wall: float = NOON, memory: SigningMemory | None = None, now: float = 0.0) -> Signing:
    """What a program with these keys has; the first one signs."""
    ring = KeyRing()
    for key in keys:
        ring = ring.add(key)
    return Signing(ring, wall=wall, now=now, memory=memory)


def vehicle(signing: Signing, policy: SigningPolicy = SIGNED_ONLY, index: int = 0, **options: object) -> Channel:
    """The channel of a vehicle 1/1."""
    guard = SigningGuard(signing, policy, index)
    return Channel("udpin:0.0.0.0:14550", index, system=1, component=1, guard=guard, **options)  # type: ignore[arg-type]


def station(signing: Signing, policy: SigningPolicy = SIGNED_ONLY) -> Channel:
    """The channel of a ground station 255/190 that sends first."""
    guard = SigningGuard(signing, policy, 0)
    return Channel("udpout:192.0.2.1:14550", 0, system=255, component=190, guard=guard, target=HERE)


def send(channel: Channel, message: Message = HEARTBEAT, now: float = 0.0) -> list[bytes]:
    """The frames that a channel sends for a message to everybody."""
    return [frame for frame, _, _ in channel.send(Outgoing(message), now=now)]
