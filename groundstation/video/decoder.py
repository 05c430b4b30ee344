"""The program that decodes: ffmpeg, or gst-launch-1.0 where that is missing. A bounded process, never a shell."""

from __future__ import annotations

import asyncio
import contextlib
import os
import re
import resource
import shutil
import signal
import subprocess
import sys
from collections.abc import AsyncIterator, Callable, Sequence
from contextlib import asynccontextmanager
from functools import cache

import msgspec

from groundstation.video.ffmpeg_command import Shape, build_ffmpeg_command
from groundstation.video.gst_command import build_gst_command
from groundstation.video.source import SourceError, VideoSource
from link.runtime.child_process import end_with_us

NOTHING_INSTALLED = "video needs ffmpeg: `apt-get install ffmpeg` (or gstreamer1.0-tools with its plugins and libav)"
MAX_MEMORY = 2 << 30
"""Bytes of addresses that the program may have: a source cannot make it take the memory of this machine."""
MAX_ERRORS = 4096
"""Bytes of what the program says that are kept."""
MAX_LINE = 200
"""Characters of it that are shown."""
READ = 1 << 16
WRITE_AGAIN = 0.005
"""s before a pipe that is full is written to again."""
END_WITHIN, END_LOOKS = 1.0, 100
"""s for a killed process to end, and how often it is looked at in that time."""
VERSION_WITHIN = 5.0
"""s for ffmpeg to tell its version."""
_NEW_FFMPEG = (5, 1)
"""The first version with -fps_mode."""


class DecoderEndedError(Exception):
    """The program has ended; the text says how, in one line."""


class DecoderProgram(msgspec.Struct, frozen=True):
    """A program that decodes."""

    path: str
    build: Callable[[str, VideoSource, Shape], list[str]]
    reads_stamps: bool = True
    """It obeys Shape.stamped."""


@cache
def find_program() -> DecoderProgram:
    """Return the program of this machine. Raises SourceError."""
    if path := shutil.which("ffmpeg"):
        return DecoderProgram(path, _build_old if _is_old(path) else build_ffmpeg_command)
    if path := shutil.which("gst-launch-1.0"):
        return DecoderProgram(path, build_gst_command, reads_stamps=False)
    raise SourceError(NOTHING_INSTALLED)


def _build_old(program: str, source: VideoSource, shape: Shape) -> list[str]:
    return build_ffmpeg_command(program, source, shape, old=True)


def _is_old(path: str) -> bool:
    """Return whether it is ffmpeg before 5.1; a build without a number is new."""
    with contextlib.suppress(OSError, subprocess.SubprocessError):
        done = subprocess.run(
            [path, "-version"], stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=VERSION_WITHIN
        )
        found = re.match(r"ffmpeg version n?(\d+)\.(\d+)", done.stdout)
        return found is not None and (int(found[1]), int(found[2])) < _NEW_FFMPEG
    return False


class Decoder:
    """A running program. What it writes is read at once, so that no picture waits in a pipe; the newest is kept.

    Not a process of asyncio: one that was killed while its pipe is not read is never at its end there.
    """

    def __init__(self, process: subprocess.Popen[bytes], shape: Shape) -> None:
        assert process.stdout is not None
        assert process.stderr is not None
        self._process = process
        self._pixels, self._words = _Pixels(shape.size), _Words()
        self._pipes = (
            _Pipe(process.stdout.fileno(), self._pixels.take),
            _Pipe(process.stderr.fileno(), self._words.take),
        )

    @property
    def pid(self) -> int:
        """Its process id."""
        return self._process.pid

    async def read(self) -> bytes:
        """Return the pixels of the newest picture. Raises DecoderEndedError; "" as its text is an end in order."""
        await self._pixels.changed.wait()
        self._pixels.changed.clear()
        if (pixels := self._pixels.pop()) is not None:
            return pixels
        with contextlib.suppress(TimeoutError):  # another program may hold its end open
            await asyncio.wait_for(self._words.ended.wait(), END_WITHIN)
        code = await self._end()
        said = self._words.last_line()
        raise DecoderEndedError("" if not code and not said else said or f"the decoder has ended ({code})")

    async def write(self, data: bytes) -> None:
        """Give the program data, as fast as it reads them. Raises DecoderEndedError."""
        assert self._process.stdin is not None
        descriptor, rest = self._process.stdin.fileno(), memoryview(data)
        os.set_blocking(descriptor, False)
        while rest:
            try:
                rest = rest[os.write(descriptor, rest) :]
            except BlockingIOError:
                await asyncio.sleep(WRITE_AGAIN)
            except OSError as error:
                raise DecoderEndedError(f"the decoder has ended: {error.strerror}") from error

    async def close(self) -> None:
        """Kill the process, also one that stands still, and close its pipes."""
        self._process.kill()
        await self._end()
        for reader in self._pipes:
            reader.close()
        for pipe in (self._process.stdin, self._process.stdout, self._process.stderr):
            if pipe is not None:
                pipe.close()

    async def _end(self) -> int | None:
        """Wait until the process has ended. One that the kernel holds, as for a camera that hangs, is left to it."""
        for _ in range(END_LOOKS):
            if self._process.poll() is not None:
                break
            await asyncio.sleep(END_WITHIN / END_LOOKS)
        return self._process.returncode


class _Pipe:
    """Reads a pipe whenever it has something, until its end; `take` gets what was read, and nothing at the end."""

    def __init__(self, descriptor: int, take: Callable[[bytes], None]) -> None:
        self._descriptor, self._take = descriptor, take
        self._loop = asyncio.get_running_loop()
        os.set_blocking(descriptor, False)
        self._loop.add_reader(descriptor, self._read)

    def close(self) -> None:
        """Read no more."""
        self._loop.remove_reader(self._descriptor)

    def _read(self) -> None:
        try:
            data = os.read(self._descriptor, READ)
        except BlockingIOError:
            return
        except OSError:
            data = b""
        if not data:
            self.close()
        self._take(data)


class _Pixels:
    """Puts pictures together, of which it keeps the newest."""

    def __init__(self, size: int) -> None:
        self.changed = asyncio.Event()
        self._size = size
        self._part = bytearray()
        self._newest: bytes | None = None

    def pop(self) -> bytes | None:
        """Return the newest picture, once."""
        found, self._newest = self._newest, None
        return found

    def take(self, data: bytes) -> None:
        """Take what was read."""
        self._part += data
        while len(self._part) >= self._size:
            self._newest = bytes(self._part[: self._size])
            del self._part[: self._size]
            self.changed.set()
        if not data:
            self.changed.set()


class _Words:
    """What a program says, of which it keeps the end."""

    def __init__(self) -> None:
        self.ended = asyncio.Event()
        self._end = b""

    def last_line(self) -> str:
        """Return the last line, without addresses of memory."""
        lines = self._end.decode(errors="replace").strip().splitlines()
        text = re.sub(r"^(?:\[[^\]]*\] ?)+", "", lines[-1]) if lines else ""
        return "".join(each if each.isprintable() else "?" for each in text)[:MAX_LINE]

    def take(self, data: bytes) -> None:
        """Take what was read."""
        self._end = (self._end + data)[-MAX_ERRORS:]
        if not data:
            self.ended.set()


@asynccontextmanager
async def running_decoder(words: Sequence[str], shape: Shape, *, fed: bool = False) -> AsyncIterator[Decoder]:
    """Start a program that writes pictures of this shape; it ends with the block. Raises OSError.

    `fed`: it reads what Decoder.write gets.
    """
    decoder = Decoder(_start(words, fed=fed), shape)
    try:
        yield decoder
    finally:
        await asyncio.shield(decoder.close())


def _start(words: Sequence[str], *, fed: bool) -> subprocess.Popen[bytes]:
    pipe = subprocess.PIPE
    process = subprocess.Popen(
        words, stdin=pipe if fed else subprocess.DEVNULL, stdout=pipe, stderr=pipe, env=_environment(),
        preexec_fn=end_with_us(signal.SIGKILL), start_new_session=True,
    )  # fmt: skip
    _limit(process.pid)
    return process


def _limit(pid: int) -> None:
    """Bound the memory of a process, where the kernel does so for others."""
    if sys.platform == "linux":
        with contextlib.suppress(OSError):  # it has ended already
            resource.prlimit(pid, resource.RLIMIT_AS, (MAX_MEMORY, MAX_MEMORY))
            resource.prlimit(pid, resource.RLIMIT_CORE, (0, 0))


def _environment() -> dict[str, str]:
    """Return our environment without what makes ffmpeg write a file of its own."""
    return {name: value for name, value in os.environ.items() if name != "FFREPORT"}
