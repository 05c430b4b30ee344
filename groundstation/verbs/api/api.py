"""`mavhelm api`: calls of a program on stdin, answers on stdout, one JSON object a line (rover/protocol.py).

What drives ends with neutral however the program ends: its stdin ends, it does not say any more that it waits, or this
process is killed (demand_guard.py).
"""

from __future__ import annotations

import argparse
import asyncio
import os
import sys
from typing import IO, Any

import msgspec

from groundstation.formats.errors import FileFormatError
from groundstation.rover.protocol import MAX_LINE, Call, Ended, decode_call
from groundstation.verbs.api.program_calls import ProgramCalls, parser_of
from groundstation.verbs.common.channel import CompanionChannel
from groundstation.verbs.common.exit_codes import ExitCode, VerbError
from groundstation.verbs.common.output import Output
from groundstation.verbs.main import choose_action
from groundstation.verbs.session.endpoints import config_error
from groundstation.verbs.session.session import VerbSession
from groundstation.verbs.table import VERBS

MOST_UNREAD = 8 << 20
"""Bytes that the program may leave unread before it counts as hanging."""
ENOUGH_UNREAD = 64 << 10
"""Bytes that the program has not read, behind which states are left out."""


async def run(session: VerbSession, options: argparse.Namespace, output: Output) -> int:
    """Run the calls of the program; done when its input ends and neutral was sent. Raises VerbError."""
    await session.need_only_vehicle(options.vehicle)
    await ProgramCalls(session, options).run()
    return ExitCode.DONE


async def serve(options: argparse.Namespace, output: Output, verb: CompanionChannel) -> None:
    """Pass on lines between stdin, stdout and the verb, as the companion. Raises VerbError."""
    loop = asyncio.get_running_loop()
    reader = asyncio.StreamReader(MAX_LINE)
    try:
        await loop.connect_read_pipe(lambda: asyncio.StreamReaderProtocol(reader), _copy(sys.stdin))
        transport, _ = await loop.connect_write_pipe(asyncio.streams.FlowControlMixin, _copy(sys.stdout))
    except (OSError, ValueError) as error:
        raise VerbError(ExitCode.USAGE, f"stdin and stdout must be pipes of the program: {error}") from None
    transport.set_write_buffer_limits(MOST_UNREAD)
    program = ProgramPipe(verb, transport)
    tasks = asyncio.ensure_future(program.read(reader)), asyncio.ensure_future(program.answer())
    try:
        ended, _ = await asyncio.wait(tasks, return_when=asyncio.FIRST_COMPLETED)
        for each in ended:
            each.result()
    finally:
        for task in tasks:
            task.cancel()


def _copy(stream: IO[str]) -> IO[bytes]:
    """Return a copy of a standard stream, which the loop closes at the end."""
    return os.fdopen(os.dup(stream.fileno()), stream.mode.replace("w", "wb").replace("r", "rb"), buffering=0)


class ProgramPipe:
    """The program at the other end of stdin and stdout."""

    def __init__(self, verb: CompanionChannel, transport: asyncio.WriteTransport) -> None:
        self._verb, self._transport = verb, transport

    async def read(self, reader: asyncio.StreamReader) -> None:
        """Pass on its calls until its input ends. Raises VerbError for what is not a call."""
        while True:
            try:
                line = await reader.readline()
            except ValueError:
                raise VerbError(ExitCode.USAGE, f"a line of the program is longer than {MAX_LINE} bytes") from None
            if not line:
                return
            try:
                call = decode_call(line)
            except msgspec.MsgspecError as error:
                raise VerbError(ExitCode.USAGE, f"a line of the program is not a call: {error}") from None
            value: dict[str, Any] = msgspec.to_builtins(call)
            if isinstance(call, Call):
                try:
                    value["given"] = _prepare(call)
                except (VerbError, FileFormatError, config_error()) as error:
                    code = error.code if isinstance(error, VerbError) else ExitCode.USAGE
                    self._write(Ended(call.id, int(code), str(error)))
                    continue
            self._verb.send(value)

    async def answer(self) -> None:
        """Pass on what the verb sends."""
        while True:
            value = await self._verb.receive()
            unread = self._transport.get_write_buffer_size()
            if unread > MOST_UNREAD:
                raise VerbError(ExitCode.BROKEN, "the program does not read what it has asked for")
            if unread < ENOUGH_UNREAD or value["type"] != "state":
                self._write(value)

    def _write(self, value: object) -> None:
        self._transport.write(msgspec.json.encode(value) + b"\n")


def _prepare(call: Call) -> Any:
    """Return what the files and the configuration of the user say about a call. Raises VerbError, ConfigError."""
    if not call.words or call.words[0] not in VERBS:
        raise VerbError(ExitCode.USAGE, f"{' '.join(call.words)[:80]!r} is not a verb")
    options = parser_of(call.words[0]).parse_args(call.words[1:])
    action = choose_action(call.words[0], options)
    return None if action.prepare is None else action.prepare(options)
