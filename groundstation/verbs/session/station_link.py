"""A verb's connection to a station that runs, in the place of links of its own."""

from __future__ import annotations

import asyncio
import contextlib
import math
from collections.abc import Callable

from dialects import codec
from dialects.messages import MESSAGES
from groundstation.station_socket.packets import read_packet
from groundstation.station_socket.relay import (
    MAX_RELAYED,
    DemandRefused,
    HeardMessage,
    LinksReport,
    MessageRefused,
    ReceivedBatch,
    ToSend,
    decode_from_station,
    encode,
)
from groundstation.station_socket.verb_run import ALIVE_PERIOD, Alive
from groundstation.verbs.client.station_choice import StationLink, StationLostError
from groundstation.verbs.common.exit_codes import ExitCode, VerbError
from link.core import Core, Peer, Received, RefusalListener
from link.protocol.log_tap import LogTap
from link.transport.receive_buffer import ReceiveBuffer


class StationRunner:
    """Drives the core of a verb over the connection, as link.runner.Runner does over links."""

    def __init__(
        self,
        core: Core,
        link: StationLink,
        period: float,
        log_tap: LogTap | None = None,
        patience: float = math.inf,
    ) -> None:
        """`log_tap` records what the station hears, as frames without signatures.

        A station that does not answer for `patience` s is lost.
        """
        self._core = core
        self._socket = link.sock
        self._buffer = ReceiveBuffer(MAX_RELAYED)
        self._period = period
        self._log_tap = log_tap
        self._endpoints = link.ready.endpoints
        self._patience = patience
        self._asked_at = -math.inf
        self._unanswered_since = math.inf
        self._ended: asyncio.Future[None] = asyncio.get_running_loop().create_future()

    async def run(self) -> None:
        """Run until stop(); raise what the core raises, StationLostError, and VerbError for a refused demand."""
        loop = asyncio.get_running_loop()
        loop.add_reader(self._socket, self._guard, self._read)
        ticking = loop.create_task(self._tick())
        try:
            await self._ended
        finally:
            ticking.cancel()
            loop.remove_reader(self._socket)
            with contextlib.suppress(Exception):
                self._flush()
            self._socket.close()

    def stop(self) -> None:
        """End run()."""
        if not self._ended.done():
            self._ended.set_result(None)

    def flush(self) -> None:
        """Send the core's messages now."""
        self._guard(self._flush)

    def observe(self) -> None:
        """Do nothing: the station reports its links by itself."""

    async def _tick(self) -> None:
        loop = asyncio.get_running_loop()
        while True:
            self._guard(self._run_tick)
            await asyncio.sleep(self._period)
            if loop.time() - self._asked_at >= ALIVE_PERIOD:
                self._guard(self._ask)

    def _ask(self) -> None:
        """Ask whether the station runs. What it has said while this process stood still is read first."""
        self._read()
        now = self._asked_at = asyncio.get_running_loop().time()
        if now - self._unanswered_since > self._patience:
            silence = f"the station has not answered for {now - self._unanswered_since:.1f} s"
            raise StationLostError(ExitCode.NO_ANSWER, silence, self._endpoints)
        self._unanswered_since = min(self._unanswered_since, now)
        self._send(ToSend())

    def _run_tick(self) -> None:
        self._core.tick(asyncio.get_running_loop().time())
        self._flush()

    def _guard(self, step: Callable[[], None]) -> None:
        if self._ended.done():
            return
        try:
            step()
        except Exception as error:
            self._ended.set_exception(error)

    def _flush(self) -> None:
        messages = tuple(
            (type(each.message).id, codec.encode_payload(each.message)) for each in self._core.messages_to_send()
        )
        if messages:
            self._send(ToSend(messages))

    def _send(self, packet: ToSend) -> None:
        with contextlib.suppress(OSError):  # a full queue: what must arrive is repeated; a station that ended: _read
            self._socket.send(encode(packet))

    def _read(self) -> None:
        now = asyncio.get_running_loop().time()
        while (packet := read_packet(self._socket, self._buffer)) is not None:
            if not packet:
                ended = "the station that this verb went through has ended"
                raise StationLostError(ExitCode.NO_ANSWER, ended, self._endpoints)
            self._unanswered_since = math.inf
            self._handle(packet, now)
        self._flush()

    def _handle(self, packet: bytes, now: float) -> None:
        match decode_from_station(packet):
            case ReceivedBatch(messages):
                for heard in messages:
                    self._take(heard, now)
            case LinksReport() as links:
                self._core.observe(links.reports, now)
            case MessageRefused(number, payload, why):
                if isinstance(self._core, RefusalListener):
                    self._core.handle_refused(codec.decode(number, payload), why, now)
            case Alive():
                pass
            case DemandRefused(line):
                raise VerbError(ExitCode.NOT_IN_CONTROL, line)

    def _take(self, heard: HeardMessage, now: float) -> None:
        if heard.message not in MESSAGES:
            return
        if self._log_tap is not None:
            raw = codec.frame(heard.message, heard.payload, heard.sequence, heard.system, heard.component)
            frame = (heard.message, heard.system, heard.component, heard.sequence, raw)
            self._log_tap.record_received([frame], heard.link, now)
        self._core.receive(_received(heard), now)


def _received(heard: HeardMessage) -> Received:
    message = codec.decode(heard.message, heard.payload)
    peer = Peer(heard.link, heard.address or "station", name=heard.name)
    return Received(message, heard.system, heard.component, heard.sequence, peer, introduced=True, named=True,
                    numbering=heard.numbering, clash=heard.clash)  # fmt: skip
