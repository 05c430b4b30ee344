"""CompanionChannel: one end of what joins a verb with its companion, the part of it in the process of the user.

A verb that a station runs has its companion in the shell (client/companion.py), with the files, the environment and
the foreign programs of the user. Values are plain: what msgpack has.
"""

from __future__ import annotations

import asyncio
from collections.abc import Callable
from typing import Any

import msgspec

from groundstation.verbs.common.exit_codes import VerbError

decode = msgspec.msgpack.Decoder().decode


class ChannelEndedError(Exception):
    """The other end has ended in order."""


class CompanionChannel:
    """One end. `send` takes a value for the other one, `push` a value that it has sent."""

    def __init__(self, send: Callable[[Any], None] = lambda value: None) -> None:
        self.send = send
        self._arrived: asyncio.Queue[Any] = asyncio.Queue()
        self._pieces = bytearray()
        self._failure: VerbError | ChannelEndedError | None = None

    def push(self, value: Any) -> None:
        """Handle a value of the other end."""
        self._arrived.put_nowait(value)

    def push_piece(self, data: bytes, *, whole: bool) -> None:
        """Handle a value, or a piece of one, as packets have it. Raises DecodeError."""
        self._pieces += data
        if whole:
            joined, self._pieces = self._pieces, bytearray()
            self.push(decode(joined))

    def end(self, failure: VerbError | None = None) -> None:
        """Handle the end of the other one."""
        self._failure = failure or ChannelEndedError()
        self._arrived.put_nowait(None)

    async def receive(self) -> Any:
        """Return the next value. Raises ChannelEndedError, or the VerbError with which the other end has failed."""
        if self._arrived.empty() and self._failure is not None:
            raise self._failure
        value = await self._arrived.get()
        if self._arrived.empty() and self._failure is not None:
            raise self._failure
        return value
