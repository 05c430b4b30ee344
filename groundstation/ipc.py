"""Messages on the pipe between the screen's process and the station process, one packet each."""

from __future__ import annotations

import time
import zlib
from functools import cache

import msgspec

from groundstation.intents.session import LEASE_TIMEOUT
from groundstation.intents.union import AnyIntent
from groundstation.snapshot import Snapshot, StationOutage
from groundstation.station_socket.hello import StationFailed
from groundstation.views.union import AnyView

MAX_PACKET = 1 << 18

MAX_INTENT_AGE = LEASE_TIMEOUT
"""s after which intents are dropped, unless they are `valid_when_late`: a station that was frozen must not drive, arm
or count the screen as alive because of packets that waited in the pipe."""


class IntentBatch(msgspec.Struct, frozen=True):
    """From the screen: the intents of one read of keys (or of one action of the screen), and when they were made."""

    time: float
    """CLOCK_MONOTONIC, s: the same in all processes, so that the station can drop an old key."""
    intents: tuple[AnyIntent, ...]


class StationReady(msgspec.Struct, frozen=True, tag=True):
    """From the station, first: the links are open."""

    endpoints: tuple[str, ...]
    first_request: int = 1
    """Number of the first request of this screen; screens of one station share the numbers."""


FromStation = StationReady | StationFailed | Snapshot | StationOutage | AnyView

encode = msgspec.msgpack.Encoder().encode


@cache  # made when it is needed, which takes 5 ms: a process needs one of the two
def _station_decoder() -> msgspec.msgpack.Decoder[FromStation]:
    return msgspec.msgpack.Decoder(FromStation)


@cache
def _screen_decoder() -> msgspec.msgpack.Decoder[IntentBatch]:
    return msgspec.msgpack.Decoder(IntentBatch)


def decode_from_station(packet: bytes) -> FromStation:
    """Return what a station has sent. Raises msgspec.DecodeError."""
    return _station_decoder().decode(packet)


def decode_from_screen(packet: bytes) -> IntentBatch:
    """Return what a screen has sent. Raises msgspec.DecodeError."""
    return _screen_decoder().decode(packet)


_SPOKEN = tuple(f"groundstation.{each}" for each in ("ipc", "intents", "views", "snapshot"))


def protocol_version() -> int:
    """Return a number that changes with any field of any packet: a screen and a station of two versions do not talk."""
    kinds = [msgspec.Struct]
    for kind in kinds:
        kinds += [each for each in kind.__subclasses__() if each.__module__.startswith(_SPOKEN)]
    lines = sorted(f"{kind.__qualname__} {kind.__annotations__}" for kind in kinds[1:])
    return zlib.crc32("\n".join(lines).encode())


def clock() -> float:
    """Return CLOCK_MONOTONIC, s: on Linux the same in all processes, which perf_counter does not guarantee."""
    return time.monotonic()
