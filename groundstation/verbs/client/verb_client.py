"""VerbClient: a verb that a station runs. This process sends the command line, and prints what the verb prints."""

from __future__ import annotations

import asyncio
import contextlib
import math
import time

from groundstation.station_socket.packets import UnsentPackets, read_packet
from groundstation.station_socket.verb_run import (
    ALIVE_PERIOD,
    MAX_PRINTED,
    CancelVerb,
    CompanionEnded,
    FileAsked,
    FromCompanion,
    FromShell,
    Printed,
    RunVerb,
    StillHere,
    ToCompanion,
    VerbEnded,
    VerbOutput,
    decode_from_station,
    encode,
    split,
)
from groundstation.verbs.client.companion import RunCompanion, RunningCompanion
from groundstation.verbs.client.file_worker import FileWorker
from groundstation.verbs.client.station_choice import StationLink, StationLostError
from groundstation.verbs.common.exit_codes import ExitCode, VerbError
from groundstation.verbs.common.output import Output
from link.transport.receive_buffer import ReceiveBuffer

HANGS_AFTER = 10.0
"""s without an answer after which a station counts as hanging. A stop does not wait that long for one."""
END_WITHIN = 1.5
"""s for an interrupted verb to end in order; the station gives it 1 s."""


class VerbClient:
    """One verb. A station that does not answer for `patience` s is lost."""

    def __init__(self, link: StationLink, output: Output, patience: float = HANGS_AFTER) -> None:
        self._socket, self._endpoints = link.sock, link.endpoints
        self._buffer = ReceiveBuffer(MAX_PRINTED)
        self._output = output
        self._patience = patience
        self._asked_at = -math.inf
        self._unanswered_since = math.inf
        self._files = FileWorker(self._send)
        self._unsent = UnsentPackets(link.sock)
        self._companion: RunningCompanion | None = None
        self.ended: VerbEnded | None = None

    async def run(self, asked: RunVerb, companion: RunCompanion | None = None) -> VerbEnded:
        """Run the verb to its end, and its companion beside it.

        Raises StationLostError, VerbError of the companion, and OSError of the output.
        """
        if companion is None:
            return await self._run(asked)
        self._companion = RunningCompanion(companion, self._send_value, self._end_early)
        try:
            return await self._run(asked)
        finally:
            await self._companion.finish()

    def _send_value(self, value: object) -> None:
        for piece in split(value):
            self._send(FromCompanion(*piece))

    def _end_early(self, failure: VerbError | None) -> None:
        self._send(CompanionEnded(failure.code, str(failure)) if failure else CompanionEnded())

    async def _run(self, asked: RunVerb) -> VerbEnded:
        loop, readable = asyncio.get_running_loop(), asyncio.Event()
        loop.add_reader(self._socket, readable.set)
        self._send(asked)
        try:
            return await self._read_to_the_end(readable)
        except asyncio.CancelledError:
            self._send(CancelVerb())
            with contextlib.suppress(TimeoutError, StationLostError):
                async with asyncio.timeout(END_WITHIN):
                    await self._read_to_the_end(readable)
            raise
        finally:
            loop.remove_reader(self._socket)
            self._socket.close()

    async def _read_to_the_end(self, readable: asyncio.Event) -> VerbEnded:
        while True:
            readable.clear()
            self._read()
            if self.ended is not None:
                return self.ended
            self._ask()
            with contextlib.suppress(TimeoutError):
                wait = max(0.0, self._asked_at + ALIVE_PERIOD - time.monotonic())
                async with asyncio.timeout(wait):  # wait_for() may lose a Ctrl-C
                    await readable.wait()

    def _ask(self) -> None:
        """Say that this process runs, and ask whether the station does.

        What it has said while this process stood still is read first.
        """
        now = time.monotonic()
        if now - self._asked_at < ALIVE_PERIOD:
            return
        self._asked_at = now
        if now - self._unanswered_since > self._patience:
            silence = f"the station has not answered for {now - self._unanswered_since:.1f} s"
            raise StationLostError(ExitCode.NO_ANSWER, silence, self._endpoints)
        self._unanswered_since = min(self._unanswered_since, now)
        if self._unsent.size:  # it has not read the last one
            self._write()
        else:
            self._send(StillHere())

    def _send(self, packet: FromShell) -> None:
        self._unsent.add(encode(packet))
        self._write()

    def _write(self) -> None:
        with contextlib.suppress(OSError):  # a station that has ended: _read
            self._unsent.write()

    def _read(self) -> None:
        while self.ended is None and (packet := read_packet(self._socket, self._buffer)) is not None:
            if not packet:
                ended = "the station that this verb went through has ended"
                raise StationLostError(ExitCode.NO_ANSWER, ended, self._endpoints)
            self._unanswered_since = math.inf
            match decode_from_station(packet):
                case VerbOutput(printed):
                    for each in printed:
                        self._print(each)
                case VerbEnded() as ended_so:
                    self.ended = ended_so
                case ToCompanion(data, whole) if self._companion is not None:
                    self._companion.channel.push_piece(data, whole=whole)
                case FileAsked() as asked:
                    self._files.work(asked)
                case _:
                    pass  # Alive

    def _print(self, printed: Printed) -> None:
        if printed.method in PRINTS:
            getattr(self._output, printed.method)(*printed.arguments, **printed.fields)


PRINTS = frozenset(("line", "record", "result", "flush", "note", "error", "count", "announce"))
"""Methods of Output that a station may call."""
