"""How messages become bytes: by this project's channel, or by pymavlink, as another implementation."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, Protocol

from pymavlink.dialects.v20 import ardupilotmega as mav

from dialects import codec
from dialects import messages as m
from link.core import Outgoing, Peer, Received
from link.protocol.channel import Channel

PEER = Peer(0, "station")


class Wire(Protocol):
    """One end of a line with one program at the other end."""

    def open(self, system: int, component: int, *, stream: bool) -> None:
        """Send as these ids from now on."""

    def receive(self, data: bytes, now: float) -> list[Received]:
        """Return the messages in bytes that have arrived."""

    def frames(self, outgoing: Outgoing, now: float) -> Iterator[bytes]:
        """Yield what to write."""


class ChannelWire:
    """The project's own channel."""

    def open(self, system: int, component: int, *, stream: bool) -> None:
        """Send as these ids from now on."""
        self._channel = Channel("vehicle", 0, system=system, component=component, target="station", stream=stream)

    def receive(self, data: bytes, now: float) -> list[Received]:
        """Return the messages in bytes that have arrived."""
        return self._channel.receive(data, "station", now)

    def frames(self, outgoing: Outgoing, now: float) -> Iterator[bytes]:
        """Yield what to write."""
        for frame, _, _ in self._channel.send(outgoing):
            yield frame


class PymavlinkWire:
    """pymavlink's MAVLink. `mavlink1`: sends MAVLink 1 only. `key`: signs with it from the beginning.

    `listens`: takes the key of a SETUP_SIGNING, as ArduPilot does over USB, where unsigned frames are accepted, too.
    """

    def __init__(
        self, *, mavlink1: bool = False, key: bytes | None = None, timestamp: int = 1, listens: bool = False
    ) -> None:
        self._mavlink1, self._listens = mavlink1, listens
        self._first = key, timestamp
        self.key: bytes | None = None

    def open(self, system: int, component: int, *, stream: bool) -> None:
        """Send as these ids from now on."""
        self._link: Any = mav.MAVLink(None, srcSystem=system, srcComponent=component)
        self._link.robust_parsing = True
        key, timestamp = self._first
        if key is not None:
            self.sign(key, timestamp)

    @property
    def signs(self) -> bool:
        """Whether what it sends is signed."""
        return bool(self._link.signing.sign_outgoing)

    @signs.setter
    def signs(self, signs: bool) -> None:
        self._link.signing.sign_outgoing = signs

    def sign(self, key: bytes, timestamp: int) -> None:
        """Sign with a key from now on."""
        self.key, signing = key, self._link.signing
        signing.secret_key, signing.link_id, signing.sign_outgoing = key, 1, True
        signing.timestamp = max(signing.timestamp, timestamp)
        signing.allow_unsigned_callback = lambda mavlink, number: True

    def receive(self, data: bytes, now: float) -> list[Received]:
        """Return the messages in bytes that have arrived."""
        received = []
        for message in self._link.parse_buffer(data) or ():
            if message.get_type() == "BAD_DATA":
                continue
            if self._listens and message.get_type() == "SETUP_SIGNING":
                self.sign(bytes(message.secret_key), message.initial_timestamp)
            ids = message.get_srcSystem(), message.get_srcComponent()
            received.append(Received(_ours(message), *ids, message.get_seq(), PEER, introduced=True))
        return received

    def frames(self, outgoing: Outgoing, now: float) -> Iterator[bytes]:
        """Yield what to write; pymavlink's dialect lacks a few messages, which the project's codec encodes."""
        message, link = outgoing.message, self._link
        number = type(message).id
        theirs = mav.mavlink_map.get(number)
        if theirs is None:
            yield codec.frame(number, codec.encode_payload(message), link.seq, link.srcSystem, link.srcComponent)
        else:
            converted = message if isinstance(message, theirs) else _convert(message, theirs)
            yield bytes(converted.pack(link, force_mavlink1=self._mavlink1))
        link.seq = (link.seq + 1) % 256


def _ours(message: Any) -> Any:
    """Return a received message in the project's class, if it has one."""
    number = message.get_msgId()
    ours = m.MESSAGES.get(number)
    if ours is None:
        return message
    if isinstance(message, mav.MAVLink_unknown):
        return codec.decode(number, bytes(message.get_payload() or b""))
    return _convert(message, ours)


def _convert(message: Any, kind: Any) -> Any:
    """Return a message with the same fields in the other implementation's class; what only that has is 0."""
    fields = {name: getattr(message, f"_{name}_raw", getattr(message, name, None)) for name in kind.fieldnames}
    return kind(**{name: value for name, value in fields.items() if value is not None})
