"""VerbPort: the station's end of the connection to one verb."""

from __future__ import annotations

import asyncio
import contextlib
import logging
import socket
from collections.abc import Callable, Sequence

import msgspec
from msgspec.structs import replace

from dialects import codec
from dialects.messages import MESSAGES, Message
from groundstation.station.relay.verb_relay import Verb, VerbRelay
from groundstation.station_socket.packets import read_packet
from groundstation.station_socket.relay import (
    BATCH,
    MAX_RELAYED,
    DemandRefused,
    HeardMessage,
    LinksReport,
    MessageRefused,
    ReceivedBatch,
    decode_from_verb,
    encode,
)
from groundstation.station_socket.verb_run import Alive, VerbReady
from link.core import LinkReport, Received
from link.transport.receive_buffer import ReceiveBuffer

log = logging.getLogger(__name__)


class VerbPort:
    """Reads what a verb sends and writes what the station receives. Neither blocks: what does not fit is lost.

    `flush` sends what the verb has queued; `ended` is called once, at the end of the verb's process.
    """

    def __init__(
        self,
        sock: socket.socket,
        relay: VerbRelay,
        verb: tuple[str, bool, bool],
        flush: Callable[[], None],
        ended: Callable[[VerbPort], None],
    ) -> None:
        """`verb`: its name, whether it takes part, and whether it follows."""
        self._socket = sock
        self._buffer = ReceiveBuffer(MAX_RELAYED)
        self._relay = relay
        self._flush = flush
        self._ended = ended
        name, takes_part, follows = verb
        self._verb = Verb(
            name, takes_part, self._deliver, self._report, self._refuse, follows=follows, tell_refusal=self._tell
        )

    def start(self, ready: VerbReady) -> None:
        """Begin; the loop runs."""
        loop = asyncio.get_running_loop()
        self._send(ready)
        self._relay.join(self._verb, loop.time())
        loop.add_reader(self._socket, self._read)

    def close(self) -> None:
        """End the connection; what the verb demanded ends with neutral."""
        loop = asyncio.get_running_loop()
        loop.remove_reader(self._socket)
        self._socket.close()
        self._relay.leave(self._verb, loop.time())

    def _read(self) -> None:
        now = asyncio.get_running_loop().time()
        while (packet := read_packet(self._socket, self._buffer)) is not None:
            if not packet:
                self._ended(self)
                break
            self._relay.hear(self._verb, now)
            try:
                messages = decode_from_verb(packet).messages
                for number, payload in messages:
                    if number in MESSAGES:
                        self._relay.handle(self._verb, codec.decode(number, payload), now)
                if not messages:
                    self._send(Alive())
            except msgspec.DecodeError:
                log.exception("invalid packet from a verb")
        self._flush()

    def _deliver(self, received: Sequence[Received]) -> None:
        for first in range(0, len(received), BATCH):
            self._send(ReceivedBatch(tuple(map(_heard, received[first : first + BATCH]))))

    def _report(self, reports: Sequence[LinkReport]) -> None:
        self._send(LinksReport(tuple(replace(each, audience=()) for each in reports)))  # addresses have no one type

    def _refuse(self, line: str) -> None:
        self._send(DemandRefused(line))

    def _tell(self, message: Message, why: str) -> None:
        self._send(MessageRefused(type(message).id, codec.encode_payload(message), why))

    def _send(self, message: msgspec.Struct) -> None:
        with contextlib.suppress(OSError):  # it does not read, or has ended, which _read sees
            self._socket.send(encode(message))


def _heard(received: Received) -> HeardMessage:
    place = (received.system, received.component, received.sequence, received.peer.link)
    payload = codec.encode_payload(received.message)
    address = received.peer.address
    where = f"{address[0]}:{address[1]}" if isinstance(address, tuple) else str(address)
    name, numbering = received.peer.name, received.numbering
    return HeardMessage(type(received.message).id, *place, payload, name, where, numbering, received.clash)
