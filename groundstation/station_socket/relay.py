"""What a verb and the station that it goes through say to each other: MAVLink messages, without frames.

The station sends those of the verb over its own links, with its own ids and its own session, so that the vehicle sees
one ground station.
"""

from __future__ import annotations

import msgspec

from groundstation.station_socket.hello import StationFailed
from groundstation.station_socket.verb_run import Alive, VerbReady
from link.core import LinkReport

MAX_RELAYED = 1 << 16
"""Bytes of the largest packet."""

BATCH = 100
"""Messages in one packet at most: 28 kB."""

KEEP = 30.0
"""s after the end of a verb for which the next one has its session: our vehicle disarms when nobody has driven it for
that time (FS_DISARM_T)."""


class HeardMessage(msgspec.Struct, frozen=True, array_like=True):
    """A message that the station has received."""

    message: int
    """Its id."""
    system: int
    component: int
    sequence: int
    link: int
    payload: bytes
    name: str = ""
    """Of its program in the fleet behind the link (link.core.Peer)."""
    address: str = ""
    """Where it came from, in words: two vehicles with one id are told apart by it."""
    numbering: int = 0
    clash: bool = False
    """As in link.core.Received."""


class ReceivedBatch(msgspec.Struct, frozen=True, tag=True):
    """From the station: what it has received, at most BATCH messages."""

    messages: tuple[HeardMessage, ...]


class LinksReport(msgspec.Struct, frozen=True, tag=True):
    """From the station, about once a second: the state of its links."""

    reports: tuple[LinkReport, ...]


class DemandRefused(msgspec.Struct, frozen=True, tag=True):
    """From the station: it does not send what moves the vehicle, or not any more; one line for the user."""

    line: str


class MessageRefused(msgspec.Struct, frozen=True, tag=True):
    """From the station: a message of the verb is not sent, because the role of the station does not allow it."""

    message: int
    payload: bytes
    why: str
    """One line for the user."""


class ToSend(msgspec.Struct, frozen=True):
    """From the verb: messages to send, ids and payloads. Without any it says that the verb runs, and asks for Alive."""

    messages: tuple[tuple[int, bytes], ...] = ()


FromStation = VerbReady | ReceivedBatch | LinksReport | DemandRefused | MessageRefused | Alive | StationFailed

encode = msgspec.msgpack.Encoder().encode
decode_from_station = msgspec.msgpack.Decoder(FromStation).decode
decode_from_verb = msgspec.msgpack.Decoder(ToSend).decode
