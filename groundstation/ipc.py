"""What travels on the pipe between the screen's process and the station's: one packet a message, nothing stored."""

from __future__ import annotations

import time

import msgspec

from groundstation.intents import (
    LEASE_TIMEOUT,
    AnyIntent,
    Disarm,
    DriveKeyUp,
    EmergencyStop,
    Quit,
    ReportKeyReleases,
    SetKeyGate,
    Stop,
)
from groundstation.snapshot import Snapshot

SOCKET_BUFFER = 1 << 20
"""Bytes asked for each way, so that a snapshot (< 60 kB) or a second of keys always fits; the kernel may give less."""

MAX_PACKET = 1 << 18


VALID_WHEN_LATE = (Stop, EmergencyStop, Disarm, DriveKeyUp, SetKeyGate, ReportKeyReleases, Quit)
"""Intents that only ever stop, or that say how things are. All others mean the moment in which they were made."""

MAX_INTENT_AGE = LEASE_TIMEOUT
"""s after which other intents are dropped: a station that was frozen must not drive, arm or call the screen alive by
what lay in the pipe meanwhile."""


class IntentBatch(msgspec.Struct, frozen=True):
    """Down: the intents of one read of keys (or of one act of the screen), and when they were made."""

    time: float
    """CLOCK_MONOTONIC, s: the clock of all processes, so that the station can refuse a key that lay around."""
    intents: tuple[AnyIntent, ...]


class StationReady(msgspec.Struct, frozen=True, tag=True):
    """Up, first: the links are open."""

    endpoints: tuple[str, ...]


class StationFailed(msgspec.Struct, frozen=True, tag=True):
    """Up, first and last: the station cannot work; one line for the user."""

    line: str


FromStation = StationReady | StationFailed | Snapshot

encode = msgspec.msgpack.Encoder().encode
decode_from_station = msgspec.msgpack.Decoder(FromStation).decode
decode_from_screen = msgspec.msgpack.Decoder(IntentBatch).decode


def clock() -> float:
    """CLOCK_MONOTONIC, s: on Linux one clock for all processes, unlike perf_counter's promise."""
    return time.monotonic()
