"""Connection: the process `mavhelm api` of one program, its calls and its newest state."""

from __future__ import annotations

import asyncio
import contextlib
import os
import signal
import subprocess
from collections import deque
from collections.abc import AsyncGenerator, Callable, Sequence
from contextvars import ContextVar
from itertools import count
from typing import Any
from weakref import WeakSet

import msgspec

from groundstation.rover.api_process import ApiProcess
from groundstation.rover.errors import BY_CODE, Disconnected, LinkLost, NoAnswer, RoverError
from groundstation.rover.protocol import (
    WAITING_PERIOD,
    Call,
    CallNote,
    CallRecord,
    Cancel,
    CurrentState,
    Ended,
    Ready,
    TextEvent,
    Waiting,
    decode_answer,
    encode,
)
from groundstation.rover.telemetry import State
from link.runtime.child_process import end_process

MAX_ANSWER = 16 << 20
"""Bytes of one line of `mavhelm api`."""
HANGS_AFTER = 5.0
"""s without any line after which a call fails."""
END_WITHIN = 3.0
"""s for it to send neutral, to disarm and to end, before it is killed."""
TEXTS_KEPT = 100
WAITS: ContextVar[Callable[[], bool]] = ContextVar("WAITS", default=lambda: True)
"""Tells whether the thread that has made a call waits for it. A coroutine does, as long as its loop runs."""

_OPEN: WeakSet[ApiConnection] = WeakSet()


def _close_in_fork() -> None:
    for each in list(_OPEN):
        each.close_in_fork()


os.register_at_fork(after_in_child=_close_in_fork)


class Outcome(msgspec.Struct, frozen=True):
    """How a call has ended."""

    fields: dict[str, Any]
    """What the verb prints last with --json."""
    records: tuple[dict[str, Any], ...]
    """What it prints before, one object each."""
    notes: tuple[str, ...]
    """What it says to a person."""


class _Running:
    """A call that has not ended."""

    def __init__(self) -> None:
        self.records: asyncio.Queue[dict[str, Any] | None] = asyncio.Queue()
        self.notes: list[str] = []
        self.ended: asyncio.Future[Ended] = asyncio.get_running_loop().create_future()


class ApiConnection:
    """One process. All methods are called in the event loop that has opened it."""

    def __init__(self, process: ApiProcess) -> None:
        self._api = process
        self._process: subprocess.Popen[bytes] | None = None
        self._input: asyncio.WriteTransport | None = None
        self._reading: asyncio.Task[None] | None = None
        self._numbers = count(1)
        self._running: dict[int, _Running] = {}
        self._cancelled: set[asyncio.Future[Ended]] = set()
        self._changed: asyncio.Future[None] | None = None
        self._pid = os.getpid()
        self._lines = 0
        """How many have arrived; a state comes ten times a second."""
        self.state: State | None = None
        """The newest one."""
        self.texts: deque[TextEvent] = deque(maxlen=TEXTS_KEPT)
        """The newest STATUSTEXT messages of the vehicle."""

    async def open(self) -> None:
        """Start the process, unless it runs already, and wait until it has found the vehicle. Raises RoverError."""
        self._process = process = self._api.running or self._api.start()
        loop, reader = asyncio.get_running_loop(), asyncio.StreamReader(MAX_ANSWER)
        await loop.connect_read_pipe(lambda: asyncio.StreamReaderProtocol(reader), process.stdout)
        self._input, _ = await loop.connect_write_pipe(asyncio.streams.FlowControlMixin, process.stdin)
        self._reading = asyncio.ensure_future(self._read(reader, process))
        _OPEN.add(self)
        try:
            while self.state is None:
                if self._reading.done():
                    raise await self._failure()
                await self.wait_for_state()
        except BaseException:
            await self.close()
            raise

    async def close(self) -> None:
        """End the process: neutral, and disarmed if the program has armed; kill it if it does not end."""
        process, self._process, self._api.running = self._process, None, None
        if process is None:
            return
        _OPEN.discard(self)
        assert self._input is not None
        assert self._reading is not None
        self._input.close()
        try:
            await asyncio.to_thread(end_process, process, END_WITHIN)
        finally:
            await asyncio.wait({self._reading}, timeout=1.0)  # the pipes close with it
            self._reading.cancel()

    async def call(self, *words: str, drives: bool = False) -> Outcome:
        """Run a verb to its end; a call that is cancelled ends with neutral. Raises RoverError."""
        number, running = self._begin(words)
        try:
            ended = await self._wait(number, running, drives=drives)
        except asyncio.CancelledError:
            self._send(Cancel(number))
            self._cancelled.add(running.ended)
            try:
                with contextlib.suppress(TimeoutError, RoverError):
                    async with asyncio.timeout(END_WITHIN):
                        await running.ended
            finally:
                self._cancelled.discard(running.ended)
            raise
        finally:
            self._running.pop(number, None)
        if ended.code:
            raise self._explain(ended)
        records = tuple(iter(running.records.get_nowait, None)) if not running.records.empty() else ()
        return Outcome(ended.fields, records, tuple(running.notes))

    async def follow(self, *words: str) -> AsyncGenerator[dict[str, Any], None]:
        """Run a verb that watches; yield what it prints. Raises RoverError."""
        number, running = self._begin(words)
        try:
            while (record := await running.records.get()) is not None:
                yield record
            ended = await running.ended
            if ended.code:
                raise self._explain(ended)
        finally:
            self._running.pop(number, None)
            if not running.ended.done() and self._process is not None:
                self._send(Cancel(number))

    async def settle(self) -> None:
        """Wait until every call has ended that was cancelled, END_WITHIN s at most."""
        with contextlib.suppress(TimeoutError):
            async with asyncio.timeout(END_WITHIN):
                while self._cancelled:
                    await asyncio.wait(set(self._cancelled))

    async def wait_for_state(self) -> None:
        """Wait for the next state, or the end of the process."""
        if self._changed is None:
            self._changed = asyncio.get_running_loop().create_future()
        await asyncio.shield(self._changed)

    def close_in_fork(self) -> None:
        """Close the copy of a fork, so that the process sees the end of the program that has opened it."""
        if self._process is not None and self._process.stdin is not None:
            os.close(self._process.stdin.fileno())

    # ---- calls ----

    def _begin(self, words: Sequence[str]) -> tuple[int, _Running]:
        number, running = next(self._numbers), _Running()
        self._running[number] = running
        try:
            self._send(Call(number, tuple(words)))
        except RoverError:
            del self._running[number]
            raise
        return number, running

    async def _wait(self, number: int, running: _Running, *, drives: bool) -> Ended:
        """Wait for the end of a call; while it drives, say that the program waits. Raises Disconnected."""
        silent = 0
        while not running.ended.done():
            before = self._lines
            await asyncio.wait({running.ended}, timeout=WAITING_PERIOD)
            if drives and WAITS.get()() and not running.ended.done():
                self._send(Waiting(number))
            silent = 0 if self._lines != before else silent + 1  # counted, because this program may have stood still
            if silent * WAITING_PERIOD > HANGS_AFTER:
                raise Disconnected(f"mavhelm has not answered for {HANGS_AFTER:g} s")
        return await running.ended

    def _send(self, value: Call | Cancel | Waiting) -> None:
        if os.getpid() != self._pid:
            raise Disconnected("this Rover belongs to the process that has opened it: a fork opens its own")
        process = self._process
        if process is None:
            raise Disconnected("this Rover is not connected")
        if process.poll() is not None:
            raise self._end_error()
        assert self._input is not None
        self._input.write(encode(value) + b"\n")

    def _explain(self, ended: Ended) -> RoverError:
        kind = BY_CODE.get(ended.code, RoverError)
        if kind is NoAnswer and self.state is not None and not self.state.alive:
            kind = LinkLost
        return kind(ended.text or f"exit code {ended.code}")

    # ---- what arrives ----

    async def _read(self, reader: asyncio.StreamReader, process: subprocess.Popen[bytes]) -> None:
        try:
            while line := await reader.readline():
                self._handle(line)
            await asyncio.to_thread(process.wait)
        finally:
            self._tell_changed()
            for running in self._running.values():
                running.records.put_nowait(None)
                if not running.ended.done():
                    running.ended.set_exception(self._end_error())

    def _handle(self, line: bytes) -> None:
        self._lines += 1
        match answer := decode_answer(line):
            case Ready():
                pass  # the first state follows
            case CurrentState():
                self.state = answer.state
                self._tell_changed()
            case TextEvent():
                self.texts.append(answer)
            case CallRecord() if answer.id in self._running:
                self._running[answer.id].records.put_nowait(answer.fields)
            case CallNote() if answer.id in self._running:
                self._running[answer.id].notes.append(answer.text)
            case Ended() if answer.id in self._running:
                running = self._running[answer.id]
                running.ended.set_result(answer)
                running.records.put_nowait(None)

    def _tell_changed(self) -> None:
        if self._changed is not None:
            changed, self._changed = self._changed, None
            changed.set_result(None)

    async def _failure(self) -> RoverError:
        """Return why the process has ended before it has found the vehicle."""
        assert self._process is not None
        return BY_CODE.get(self._process.wait(), RoverError)(self._api.last_error)

    def _end_error(self) -> RoverError:
        """Return why calls that run have failed with the process: a person at a screen drives, for example."""
        kind = None if self._process is None else BY_CODE.get(self._process.returncode or 0)
        return Disconnected(self._how_it_ended) if kind is None else kind(self._api.last_error)

    @property
    def _how_it_ended(self) -> str:
        code = None if self._process is None else self._process.returncode
        if code is not None and code < 0:
            return f"mavhelm has ended: {signal.Signals(-code).name}"
        return f"mavhelm has ended: {self._api.last_error}"
