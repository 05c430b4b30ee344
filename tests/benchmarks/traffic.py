"""The input of the framer benchmark: a real telemetry log if there is one, and a seeded mix of seven kinds."""

from __future__ import annotations

import random
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path

from dialects import codec
from dialects.messages import (
    Attitude,
    GlobalPositionInt,
    Heartbeat,
    LocalPositionNed,
    Message,
    RoverDriveStatus,
    ServoOutputRaw,
    VfrHud,
)
from tests.recorded import read_recording

TLOG_STAMP = 8
"""Bytes before each frame of a telemetry log: Unix time in us."""


def telemetry_log(path: Path, most: int) -> list[bytes]:
    """Return the first `most` frames of a log, one per item. Raises OSError, lzma.LZMAError."""
    return list(_frames(read_recording(path), most))


def _frames(data: bytes, most: int) -> Iterator[bytes]:
    at = TLOG_STAMP
    for _ in range(most):
        if at + codec.HEADER_V2 > len(data):
            return
        end = at + _length(data, at)
        yield data[at:end]
        at = end + TLOG_STAMP


def _length(data: bytes, at: int) -> int:
    if data[at] == codec.MAGIC_V1:
        return codec.HEADER_V1 + data[at + 1] + codec.CRC_SIZE
    signature = codec.SIGNATURE_SIZE if data[at + 2] & codec.INCOMPAT_SIGNED else 0
    return codec.HEADER_V2 + data[at + 1] + codec.CRC_SIZE + signature


def mix(count: int, seed: int = 1) -> list[bytes]:
    """Return `count` frames of system 1, as `telemetry` makes them."""
    return [framed(message, number & 0xFF) for number, message in enumerate(telemetry(random.Random(seed), count))]


def telemetry(chance: random.Random, count: int) -> Iterator[Message]:
    """Yield `count` messages, as a rover sends them: fast state often, slow state seldom, all values changing."""
    makers = list(_MAKERS)
    weights = [_MAKERS[maker] for maker in makers]
    return (maker(chance) for maker in chance.choices(makers, weights, k=count))


def framed(message: Message, sequence: int, system: int = 1, component: int = 1) -> bytes:
    """Return one MAVLink 2 frame."""
    return codec.frame(type(message).id, codec.encode_payload(message), sequence, system, component)


def joined(frames: Sequence[bytes], size: int) -> list[bytes]:
    """Return datagrams of `size` frames."""
    return [b"".join(frames[start : start + size]) for start in range(0, len(frames), size)]


def chopped(frames: Sequence[bytes], size: int) -> list[bytes]:
    """Return reads of `size` bytes, without regard to frames, as from a serial port."""
    data = b"".join(frames)
    return [data[start : start + size] for start in range(0, len(data), size)]


def _heartbeat(_: random.Random) -> Message:
    return Heartbeat(10, 0, 193, 0, 4, 3)


def _attitude(chance: random.Random) -> Message:
    return Attitude(chance.getrandbits(24), *(chance.uniform(-0.5, 0.5) for _ in range(6)))


def _vfr_hud(chance: random.Random) -> Message:
    return VfrHud(chance.random(), chance.random(), chance.randrange(360), chance.randrange(100), 30.0, 0.1)


def _position(chance: random.Random) -> Message:
    latitude, longitude = 525_163_000 + chance.randrange(9999), 133_777_000 + chance.randrange(9999)
    vx, vy, vz = (chance.randrange(-200, 200) for _ in range(3))
    heading = chance.randrange(36000)
    return GlobalPositionInt(chance.getrandbits(24), latitude, longitude, 34_000, 0, vx, vy, vz, heading)


def _servos(chance: random.Random) -> Message:
    return ServoOutputRaw(chance.getrandbits(30), 0, *(chance.randrange(1000, 2000) for _ in range(2)), *[0] * 6)


def _local_position(chance: random.Random) -> Message:
    return LocalPositionNed(chance.getrandbits(24), *(chance.uniform(-50, 50) for _ in range(6)))


def _drive_status(chance: random.Random) -> Message:
    output = [chance.randrange(-1000, 1000) for _ in range(2)] + [0] * 2
    demand = (chance.randrange(500), chance.randrange(-1000, 1000), chance.randrange(-1000, 1000))
    return RoverDriveStatus(chance.getrandbits(24), *demand, output, 0, 255, chance.randrange(256))


_MAKERS: dict[Callable[[random.Random], Message], int] = {
    _heartbeat: 1,
    _drive_status: 5,
    _attitude: 4,
    _vfr_hud: 4,
    _local_position: 4,
    _position: 2,
    _servos: 2,
}
"""Kind -> Hz: HEARTBEAT and the six that our vehicle sends most often (vehicle/telemetry/streams.py)."""
