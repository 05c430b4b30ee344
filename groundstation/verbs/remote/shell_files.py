"""ShellFiles: the files of a shell whose verb a station runs. The shell does the work (client/file_worker.py)."""

from __future__ import annotations

import asyncio
from collections.abc import Awaitable, Callable
from itertools import count

from groundstation.station_socket.verb_run import PIECE, FileAnswered, FileAsked
from groundstation.verbs.common.exit_codes import ExitCode, VerbError
from groundstation.verbs.common.files import Files, FileWork


class ShellFiles(Files):
    """One piece of one file is on its way at a time: neither end has more than the socket takes.

    `ask` sends a packet to the shell and returns its answer.
    """

    def __init__(self, ask: Callable[[FileAsked], Awaitable[FileAnswered]]) -> None:
        self._ask = ask
        self._numbers = count(1)
        self._free = asyncio.Lock()

    async def do(self, work: FileWork, path: str, data: bytes = b"", *, overwrite: bool = False) -> bytes:
        """Have the shell do something with a file; return what was read. Raises VerbError."""
        async with self._free:
            return await self._do(work, path, data, overwrite)

    async def _do(self, work: FileWork, path: str, data: bytes, overwrite: bool) -> bytes:
        number, at = next(self._numbers), 0
        while len(data) - at > PIECE:
            await self._ask(FileAsked(number, work, path, data[at : at + PIECE], whole=False))
            at += PIECE
        answer = await self._ask(FileAsked(number, work, path, data[at:], overwrite=overwrite))
        if answer.error:
            raise VerbError(ExitCode.USAGE, answer.error)
        pieces = [answer.data]
        while not answer.whole:
            answer = await self._ask(FileAsked(number))
            pieces.append(answer.data)
        return b"".join(pieces)
