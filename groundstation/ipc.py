"""Messages on the pipe between the screen's process and the station process, one packet each."""

from __future__ import annotations

import time

import msgspec

from groundstation.intents.session import LEASE_TIMEOUT
from groundstation.intents.union import AnyIntent
from groundstation.snapshot import Snapshot, StationOutage
from groundstation.views.union import AnyView

SOCKET_BUFFER = 1 << 20
"""Bytes requested each way, so that a snapshot (< 60 kB) or a second of keys fits; the kernel may grant less."""

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


class StationFailed(msgspec.Struct, frozen=True, tag=True):
    """From the station, first and last: the station could not start; one line for the user."""

    line: str


FromStation = StationReady | StationFailed | Snapshot | StationOutage | AnyView

encode = msgspec.msgpack.Encoder().encode
decode_from_station = msgspec.msgpack.Decoder(FromStation).decode
decode_from_screen = msgspec.msgpack.Decoder(IntentBatch).decode


def clock() -> float:
    """Return CLOCK_MONOTONIC, s: on Linux the same in all processes, which perf_counter does not guarantee."""
    return time.monotonic()
