"""The replay process: reads a telemetry log in place of a station process. It has no links, so nothing can be sent."""

from __future__ import annotations

import argparse
import asyncio
import gc
import logging
import os
import signal
import socket
from pathlib import Path

from dialects.extra.errors import DialectError
from dialects.extra.option import use_dialect
from groundstation.disk.texts_folder import load_texts
from groundstation.host.options import log_to, open_screen_pipes
from groundstation.host.screen_port import ScreenPort
from groundstation.host_process import REPLAY
from groundstation.intents.session import Quit
from groundstation.ipc import IntentBatch, StationReady, encode
from groundstation.replay.log_clock import LogClock
from groundstation.replay.log_replay import LogReplay
from groundstation.replay.time_text import TimeError, parse_time
from groundstation.station.station import Station
from groundstation.station_socket.hello import StationFailed
from link.runtime.event_loop import run_loop
from link.tlog.scan import foreign_log, scan

log = logging.getLogger(__name__)

SNAPSHOT_PERIOD = 0.1
STEP = 0.025
"""s between two steps of playing."""
SLICE = 0.015
"""s of work in the background between two looks at the pipe."""
GROWTH_PERIOD = 2.0
"""s between two looks whether the file has grown."""
LOOK = 1 << 20
"""Bytes at the beginning in which a telemetry log must have a frame."""
NICENESS = 5
"""The screen, and a station that drives, go first."""


class ReplayError(Exception):
    """The file cannot be replayed; the message is one line for the user."""


class FileSource:
    """An open file. Read at places and not mapped: a mapped file that becomes shorter would kill the process."""

    def __init__(self, path: Path) -> None:
        """Open it. Raises ReplayError."""
        try:
            if path.is_dir():
                raise ReplayError(f"{path}: is a folder: name a telemetry log (.tlog)")
            if not path.is_file() and path.exists():
                raise ReplayError(f"{path}: is not a regular file: name a telemetry log (.tlog)")
            if not path.exists():
                raise ReplayError(f"{path}: no such file: name a telemetry log (.tlog)")
            self._descriptor = os.open(path, os.O_RDONLY | os.O_CLOEXEC)
        except OSError as error:
            raise ReplayError(f"{path}: {error.strerror}") from error
        self._size = 0
        self.measure()

    @property
    def size(self) -> int:
        """Bytes at the last look."""
        return self._size

    def measure(self) -> None:
        """Look how large the file is now."""
        try:
            self._size = os.fstat(self._descriptor).st_size
        except OSError as error:
            log.warning("the log cannot be measured: %s", error)

    def read(self, at: int, count: int) -> bytes:
        """Return bytes; none where the disk fails."""
        try:
            return os.pread(self._descriptor, max(0, min(count, self._size - at)), at)
        except OSError as error:
            log.warning("the log cannot be read at %d: %s", at, error)
            return b""


def open_log(path: Path) -> FileSource:
    """Open a telemetry log. Raises ReplayError for anything else."""
    source = FileSource(path)
    if not source.size:
        raise ReplayError(f"{path}: is empty")
    block = source.read(0, LOOK)
    if foreign := foreign_log(block):
        raise ReplayError(f"{path}: {foreign}")
    if not scan(block, 0, len(block), final=True).frames:
        raise ReplayError(f"{path}: is not a telemetry log (.tlog): no MAVLink frame in its first {len(block)} bytes")
    return source


class ReplayProcess:
    """One log and the pipe to the screen."""

    def __init__(self, replay: LogReplay, source: FileSource, pipe: socket.socket) -> None:
        self._replay = replay
        self._source = source
        self._port = ScreenPort(pipe, self)
        self._ended: asyncio.Future[None] | None = None
        self._snapshot_due = self._growth_due = 0.0

    async def run(self) -> int:
        """Run until the screen quits or exits. Raises what a step raises."""
        loop = asyncio.get_running_loop()
        self._ended = loop.create_future()
        for number in (signal.SIGTERM, signal.SIGHUP):
            loop.add_signal_handler(number, self._end)
        self._port.start()
        loop.call_soon(self._run_step)
        try:
            await self._ended
        finally:
            self._port.stop()
        return 0

    def _run_step(self) -> None:
        """Do one step and plan the next one."""
        loop = asyncio.get_running_loop()
        if self._ended is None or self._ended.done():
            return
        try:
            pause = self._step(loop.time())
        except Exception as error:  # a callback of the loop has no caller to raise to
            self._ended.set_exception(error)
        else:
            loop.call_later(pause, self._run_step)

    def _step(self, now: float) -> float:
        """Play, show and work. Returns the s until the next step."""
        if now >= self._growth_due:
            self._growth_due = now + GROWTH_PERIOD
            self._source.measure()
        self._replay.advance(now)
        if now >= self._snapshot_due:
            self._snapshot_due = now + SNAPSHOT_PERIOD
            self._port.send(self._replay.snapshot())
        self._replay.send_views(self._port.send, now)
        more, loop = True, asyncio.get_running_loop()
        while more and loop.time() < now + SLICE:
            more = self._replay.work()
        return 0.0 if more else max(0.0, now + STEP - loop.time())

    def _end(self) -> None:
        if self._ended is not None and not self._ended.done():
            self._ended.set_result(None)

    # ---- the screen ----

    def handle_batch(self, port: ScreenPort, batch: IntentBatch, now: float) -> None:
        """Carry out the intents of one packet."""
        for intent in batch.intents:
            if isinstance(intent, Quit):
                self._end()
            else:
                self._replay.handle(intent)

    def handle_screen_end(self, port: ScreenPort, now: float) -> None:
        """End with the screen."""
        self._end()

    def finish_read(self, port: ScreenPort, now: float) -> None:
        """Show what has changed at once."""
        self._snapshot_due = 0.0


def main() -> int:
    """Replay a log for the screen at the other end of --fd. Returns 2 if it cannot be, after sending why."""
    pipe, _, options = open_screen_pipes(_parser())
    if options is None:
        return 0
    try:
        log_to(options.log_file)
        use_dialect(options.dialect)
        source = open_log(options.file)
        if options.at:
            parse_time(options.at, LogClock(), 0.0)
    except (DialectError, ReplayError, TimeError, OSError) as error:
        pipe.send(encode(StationFailed(str(error))))
        return 2
    pipe.send(encode(StationReady((options.file.name,))))
    return _run(options, source, pipe)


def _run(options: argparse.Namespace, source: FileSource, pipe: socket.socket) -> int:
    texts = load_texts(options.param_docs)
    name = options.file.name

    def build(system: int, now: float) -> Station:
        return Station((name,), system=system, texts=texts, now=now)

    replay = LogReplay(str(options.file.absolute()), source, build, at=options.at, speed=options.speed)
    gc.collect()
    gc.freeze()
    os.nice(NICENESS)
    try:
        return run_loop(_show(replay, source, pipe))
    except Exception:
        log.exception("replay crashed")
        return 1


async def _show(replay: LogReplay, source: FileSource, pipe: socket.socket) -> int:
    return await ReplayProcess(replay, source, pipe).run()


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(REPLAY)
    parser.add_argument("--log-file", type=Path)
    parser.add_argument("--dialect", metavar="FILE.xml")
    parser.add_argument("--param-docs", type=Path, help="file with texts of parameters")
    parser.add_argument("--at", default="", help="time at which it begins")
    parser.add_argument("--speed", type=float, default=1.0)
    parser.add_argument("file", type=Path)
    return parser


if __name__ == "__main__":
    raise SystemExit(main())
