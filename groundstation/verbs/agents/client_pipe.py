"""The messages of an MCP client on stdin and stdout: one JSON-RPC message a line, of a bounded size.

The SDK's own transport reads lines of any length and drops what is no message without a word.
"""

from __future__ import annotations

import asyncio
import contextlib
import os
import sys
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from typing import IO

import anyio
import mcp_types as types
from anyio.streams.memory import MemoryObjectReceiveStream, MemoryObjectSendStream
from mcp.shared.message import SessionMessage
from pydantic import ValidationError

from groundstation.verbs.common.exit_codes import ExitCode, VerbError

MAX_LINE = 4 << 20
"""Bytes of one message of a client. What is longer gets no answer with its id, and its call waits for ever."""
MOST_UNREAD = 8 << 20
"""Bytes that the client may leave unread before it counts as hanging."""

Incoming = MemoryObjectReceiveStream[SessionMessage | Exception]
Outgoing = MemoryObjectSendStream[SessionMessage]


class ClientPipe:
    """Reads and writes lines."""

    def __init__(self, reader: asyncio.StreamReader, writer: asyncio.WriteTransport) -> None:
        self._reader, self._writer = reader, writer

    async def read_into(self, stream: MemoryObjectSendStream[SessionMessage | Exception]) -> None:
        """Pass on messages until the client ends; answer what is none with an error."""
        with contextlib.suppress(anyio.BrokenResourceError, anyio.ClosedResourceError):
            async with stream:
                while (line := await self._read_line()) is not None:
                    if not line:
                        self._refuse(types.INVALID_REQUEST, f"a message is longer than {MAX_LINE} bytes: dropped")
                        continue
                    try:
                        message = types.jsonrpc_message_adapter.validate_json(line, by_name=False)
                    except (ValidationError, RecursionError):
                        self._refuse(types.PARSE_ERROR, "a line is not a JSON-RPC message: dropped")
                        continue
                    await stream.send(SessionMessage(message))

    async def write_from(self, stream: MemoryObjectReceiveStream[SessionMessage]) -> None:
        """Write what the server sends. Raises VerbError for a client that does not read."""
        async with stream:
            async for each in stream:
                self._write(each.message.model_dump_json(by_alias=True, exclude_unset=True))

    async def _read_line(self) -> bytes | None:
        """Return the next line with its end; None at the end of the input, b"" for one that is too long."""
        try:
            return await self._reader.readuntil() or None
        except asyncio.IncompleteReadError:
            return None
        except asyncio.LimitOverrunError as error:
            await self._skip_line(error.consumed)
            return b""

    async def _skip_line(self, size: int) -> None:
        while True:
            await self._reader.readexactly(size)
            try:
                await self._reader.readuntil()
            except asyncio.LimitOverrunError as error:
                size = error.consumed
            except asyncio.IncompleteReadError:
                return
            else:
                return

    def _refuse(self, code: int, text: str) -> None:
        sys.stderr.write(f"mavhelm mcp: {text}\n")
        error = types.JSONRPCError(jsonrpc="2.0", id=None, error=types.ErrorData(code=code, message=text))
        self._write(error.model_dump_json(by_alias=True, exclude_unset=True))

    def _write(self, line: str) -> None:
        if self._writer.get_write_buffer_size() > MOST_UNREAD:
            raise VerbError(ExitCode.BROKEN, "the client does not read what it has asked for")
        self._writer.write(line.encode() + b"\n")


@asynccontextmanager
async def open_client() -> AsyncIterator[tuple[Incoming, Outgoing]]:
    """Yield the streams of the client on stdin and stdout. Raises VerbError."""
    loop = asyncio.get_running_loop()
    reader = asyncio.StreamReader(MAX_LINE)
    try:
        await loop.connect_read_pipe(lambda: asyncio.StreamReaderProtocol(reader), _copy(sys.stdin))
        writer, _ = await loop.connect_write_pipe(asyncio.streams.FlowControlMixin, _copy(sys.stdout))
    except (OSError, ValueError) as error:
        raise VerbError(ExitCode.USAGE, f"stdin and stdout must be pipes of an MCP client: {error}") from None
    sys.stdout = sys.stderr  # nothing else may be between the messages
    pipe = ClientPipe(reader, writer)
    arriving, incoming = anyio.create_memory_object_stream[SessionMessage | Exception](0)
    outgoing, leaving = anyio.create_memory_object_stream[SessionMessage](0)
    async with anyio.create_task_group() as tasks:
        tasks.start_soon(pipe.read_into, arriving)
        tasks.start_soon(pipe.write_from, leaving)
        yield incoming, outgoing
        tasks.cancel_scope.cancel()


def _copy(stream: IO[str]) -> IO[bytes]:
    """Return a copy of a standard stream, which the loop closes at the end."""
    return os.fdopen(os.dup(stream.fileno()), stream.mode.replace("w", "wb").replace("r", "rb"), buffering=0)
