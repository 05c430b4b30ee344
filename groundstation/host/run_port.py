"""RunPort: the station's end of the connection to a shell whose verb runs here."""

from __future__ import annotations

import asyncio
import contextlib
import logging
import socket
from collections.abc import Callable
from importlib import import_module

import msgspec

from groundstation.station.station import Station
from groundstation.station_socket.packets import UnsentPackets, read_packet
from groundstation.station_socket.verb_run import (
    MAX_PRINTED,
    Alive,
    CancelVerb,
    CompanionEnded,
    FileAnswered,
    FileAsked,
    FromCompanion,
    FromShell,
    Printed,
    RunVerb,
    StillHere,
    ToCompanion,
    VerbEnded,
    VerbOutput,
    VerbReady,
    decode_from_shell,
    encode,
    split,
)
from groundstation.verbs.common.channel import CompanionChannel
from groundstation.verbs.common.exit_codes import ExitCode, VerbError
from link.transport.receive_buffer import ReceiveBuffer

log = logging.getLogger(__name__)

GONE = "the shell with the file has ended"

MAX_BATCH = 1 << 15
"""Bytes after which what a verb has printed goes into another packet."""

MAX_UNREAD = 1 << 23
"""Bytes that a shell may leave unread: the output of a verb for 64 vehicles is smaller. Then its verb ends."""

RUNNER = "groundstation.verbs.remote.runner"
"""It loads the verbs, which takes longer than the station may stand still."""


class RunPort:
    """Runs the verb of one shell. Reading and writing never block.

    `flush` sends what the verb has queued; `ended` is called once, at the end of the connection.
    """

    def __init__(
        self,
        sock: socket.socket,
        station: Station,
        name: str,
        flush: Callable[[], None],
        ended: Callable[[RunPort], None],
        *,
        follows: bool,
    ) -> None:
        self._socket = sock
        self._buffer = ReceiveBuffer(MAX_PRINTED)
        self._station, self._name, self._follows = station, name, follows
        self._flush, self._ended = flush, ended
        self._heard_at = 0.0
        self._printed: list[bytes] = []
        """What is printed and in no packet yet."""
        self._unread = UnsentPackets(sock)
        self._task: asyncio.Task[None] | None = None
        self._asked = 0
        """Number of the file on which the shell works; an answer about another one is that of an interrupted verb."""
        self._answer: asyncio.Future[FileAnswered] | None = None
        """What its verb waits for while the shell works on a file; on one at a time (remote/shell_files.py)."""
        self._companion = CompanionChannel(self._send_value)
        self._open = True

    def start(self, ready: VerbReady) -> None:
        """Begin; the loop runs."""
        loop = asyncio.get_running_loop()
        self._heard_at = loop.time()
        self._send(encode(ready))
        loop.add_reader(self._socket, self._read)

    def close(self) -> None:
        """End the connection, and the verb in order."""
        if not self._open:
            return
        self._open = False
        loop = asyncio.get_running_loop()
        loop.remove_reader(self._socket)
        loop.remove_writer(self._socket)
        self._socket.close()
        self._end_work(FileAnswered(0, error=GONE))
        if self._task is not None:
            self._task.cancel()

    def _read(self) -> None:
        now = asyncio.get_running_loop().time()
        while self._open and (packet := read_packet(self._socket, self._buffer)) is not None:
            self._heard_at = now
            if not packet:
                self._end()
                return
            try:
                self._handle(decode_from_shell(packet))
            except (msgspec.DecodeError, ValueError):  # no packet, or no exit code
                log.exception("invalid packet from a shell")

    def _handle(self, packet: FromShell) -> None:
        if isinstance(packet, RunVerb) and self._task is None and packet.words:
            self._task = asyncio.get_running_loop().create_task(self._run(packet))
        elif isinstance(packet, CancelVerb) and self._task is not None:
            self._task.cancel()
        elif isinstance(packet, StillHere):
            self._send(encode(Alive()))
        elif isinstance(packet, FromCompanion):
            self._companion.push_piece(packet.data, whole=packet.whole)
        elif isinstance(packet, CompanionEnded):
            self._companion.end(VerbError(ExitCode(packet.code), packet.line) if packet.line else None)
        elif isinstance(packet, FileAnswered) and packet.number == self._asked:
            self._end_work(packet)

    async def _ask_for_file(self, asked: FileAsked) -> FileAnswered:
        """Have the shell work on a file; return its answer."""
        if not self._open:
            return FileAnswered(asked.number, error=GONE)
        self._asked, self._answer = asked.number, asyncio.get_running_loop().create_future()
        self._send(encode(asked))
        return await self._answer

    def _end_work(self, answer: FileAnswered) -> None:
        if self._answer is not None and not self._answer.done():
            self._answer.set_result(answer)

    async def _run(self, asked: RunVerb) -> None:
        ended = VerbEnded(0)
        try:
            runner = await asyncio.to_thread(import_module, RUNNER)
            verb = runner.ShellVerb(
                self._station,
                self._name,
                follows=self._follows,
                flush=self._flush,
                send=self._print,
                ask_for_file=self._ask_for_file,
                companion=self._companion,
                silence=lambda now: now - self._heard_at,
            )
            ended = await verb.run(asked)
        finally:
            self._write_printed()
            self._send(encode(ended))

    def _print(self, printed: Printed) -> None:
        """Send what is printed with what else is printed in this run of the loop."""
        if not self._printed:
            asyncio.get_running_loop().call_soon(self._write_printed)
        self._printed.append(encode(printed))

    def _write_printed(self) -> None:
        batch: list[msgspec.Raw] = []
        size = 0
        for each in self._printed:
            if batch and size + len(each) > MAX_BATCH:
                self._send(encode(VerbOutput(tuple(batch))))  # type: ignore[arg-type]
                batch, size = [], 0
            batch.append(msgspec.Raw(each))
            size += len(each)
        self._printed.clear()
        if batch:
            self._send(encode(VerbOutput(tuple(batch))))  # type: ignore[arg-type]

    def _send_value(self, value: object) -> None:
        for piece in split(value):
            self._send(encode(ToCompanion(*piece)))

    def _send(self, packet: bytes) -> None:
        if self._open:
            self._unread.add(packet)
            self._write()

    def _write(self) -> None:
        loop = asyncio.get_running_loop()
        try:
            done = self._unread.write()
        except OSError:
            self._end()
            return
        if done:
            with contextlib.suppress(ValueError):
                loop.remove_writer(self._socket)
            return
        loop.add_writer(self._socket, self._write)
        if self._unread.size > MAX_UNREAD:
            log.warning("%s does not read what it prints: ended", self._name)
            self._end()

    def _end(self) -> None:
        self._ended(self)
