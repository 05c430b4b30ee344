"""Writing to a real pipe: frames stay whole when it fills up, and errors are passed on."""

from __future__ import annotations

import asyncio
import contextlib
import errno
import fcntl
import os
from collections.abc import Iterator

import pytest

from dialects.messages import Attitude
from link.transport.priority_queue import TransmitPacer, TransmitQueue
from link.transport.stream_writer import MAX_JOINED, StreamWriter
from tests.link.frames import demand, frame
from tests.waits import until

PIPE = 4096
"""Bytes that the pipe holds."""


class Pipe:
    """A pipe that nobody reads until the test does."""

    def __init__(self) -> None:
        self.reader, self.writer = os.pipe()
        fcntl.fcntl(self.writer, fcntl.F_SETPIPE_SZ, PIPE)
        os.set_blocking(self.reader, False)
        os.set_blocking(self.writer, False)
        self.received = b""
        self.writes: list[int] = []
        self.errors: list[OSError] = []

    def write(self, data: bytes) -> int:
        self.writes.append(len(data))
        return os.write(self.writer, data)

    def read(self, most: int = PIPE) -> bool:
        """Take what is there; return whether that was anything."""
        with contextlib.suppress(BlockingIOError):
            piece = os.read(self.reader, most)
            self.received += piece
            return bool(piece)
        return False

    def close(self) -> None:
        for descriptor in (self.reader, self.writer):
            with contextlib.suppress(OSError):
                os.close(descriptor)

    def start(self, limit: int = 100_000, pacer: TransmitPacer | None = None) -> StreamWriter:
        return StreamWriter(self.writer, TransmitQueue(limit), self.write, self.errors.append, pacer=pacer)


@pytest.fixture
def pipe() -> Iterator[Pipe]:
    pipe = Pipe()
    yield pipe
    pipe.close()


def telemetry(number: int) -> bytes:
    return frame(Attitude(number, 0.5, 0, 0, 0, 0, 1), number % 256, 1, 1)


async def test_a_frame_is_written_at_once(pipe: Pipe) -> None:
    pipe.start().send(telemetry(1))
    assert pipe.read()
    assert pipe.received == telemetry(1)


async def test_frames_stay_whole_and_in_order_when_the_pipe_fills_up(pipe: Pipe) -> None:
    writer = pipe.start()
    frames = [telemetry(number) for number in range(1000)]
    for data in frames:
        writer.send(data)
    assert len(b"".join(frames)) > 2 * PIPE
    await until(lambda: not pipe.read(777) and len(pipe.received) == len(b"".join(frames)))
    assert pipe.received == b"".join(frames)
    assert max(pipe.writes) < MAX_JOINED + len(frames[0])  # a backlog in few calls, none of them long
    assert pipe.errors == []


async def test_a_demand_overtakes_all_but_the_half_written_frame(pipe: Pipe) -> None:
    writer = pipe.start()
    frames = [telemetry(number) for number in range(300)]
    for data in frames:
        writer.send(data)
    writer.send(demand(7))
    await until(lambda: not pipe.read() and demand(7) in pipe.received and pipe.received.endswith(frames[-1]))
    before, _, behind = pipe.received.partition(demand(7))
    assert before + behind == b"".join(frames)
    assert len(behind) > 0
    assert len(before) < PIPE + MAX_JOINED + len(frames[0])


async def test_at_the_end_what_fits_is_written_and_the_rest_dropped(pipe: Pipe) -> None:
    pacer = TransmitPacer(100.0)
    writer = pipe.start(pacer=pacer)
    frames = [telemetry(number) for number in range(3)]
    for data in frames:
        writer.send(data)
    pipe.read()
    assert pipe.received == frames[0]  # the line is slow
    writer.flush_and_close()
    pipe.read()
    assert pipe.received == b"".join(frames)


async def test_after_close_nothing_is_written(pipe: Pipe) -> None:
    writer = pipe.start()
    for number in range(1000):
        writer.send(telemetry(number))
    writer.close()
    while pipe.read():
        pass
    size = len(pipe.received)
    assert size <= PIPE
    for _ in range(20):
        await asyncio.sleep(0)
    assert not pipe.read()


async def test_an_error_is_passed_on_and_a_full_pipe_is_none(pipe: Pipe) -> None:
    writer = pipe.start()
    for number in range(1000):
        writer.send(telemetry(number))
    assert pipe.errors == []
    os.close(pipe.reader)
    await until(lambda: pipe.errors)
    assert pipe.errors[0].errno == errno.EPIPE
    writer.close()
