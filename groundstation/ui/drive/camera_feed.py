"""The camera of the Drive screen: decodes the stream that the station has found, while a pane shows it."""

from __future__ import annotations

import asyncio
import math
import socket
import time
from collections.abc import Callable
from pathlib import Path

import msgspec

from groundstation.intents.driving import CLOCK_ERROR, OLDEST_PICTURE
from groundstation.pictures.freshness import Freshness, PictureState
from groundstation.pictures.picture import Picture
from groundstation.pictures.protocol import Protocol
from groundstation.ui.terminal.picture_output import PictureOutput
from groundstation.video.decoder import find_program
from groundstation.video.feed import Feed
from groundstation.video.ffmpeg_command import Shape
from groundstation.video.recorded_feed import RecordedFeed
from groundstation.video.source import SourceError, parse_source
from groundstation.views.camera import CameraRequest, CameraView

RATE = 30.0
"""Pictures a second at most that are decoded: each tells how old the picture is. Fewer are drawn."""
WRAP = 2**32 / 1000
"""s after which a stamp begins again at 0."""
RECORDED_RATE = 1000.0
"""Recorded pictures a second: all of them, also where many are decoded for one moment."""
LOOPBACK = "127.0.0.1"
PORT_TRIES = 50


class CameraValue(msgspec.Struct, frozen=True):
    """What the pane shows."""

    picture: Picture | None = None
    text: str = "waiting for the station"
    grey: bool = True
    protocol: Protocol = Protocol.BLOCKS
    """How it is drawn."""
    level: int = 0
    """How coarse; 0 is fine."""
    number: int = 0
    """Pictures that were shown so far."""


class _Wanted(msgspec.Struct, frozen=True):
    """What is to be decoded."""

    system: int
    log: str
    """"": the stream that the station receives."""
    stamped: bool
    size: tuple[int, int]


class CameraFeed:
    """One stream or recording at a time. Times are those of the monotonic clock that station and screen share."""

    def __init__(self, on_picture: Callable[[], None], output: PictureOutput | None = None) -> None:
        """`output`: the terminal; None: one of which nothing is known."""
        self.output = PictureOutput() if output is None else output
        self._on_picture = on_picture
        self._view: CameraView | None = None
        self._feed: Feed | None = None
        self._recorded: RecordedFeed | None = None
        self._task: asyncio.Task[None] | None = None
        self._wanted: _Wanted | None = None
        self._port = 0
        self._picture: Picture | None = None
        self._shown: Picture | None = None
        """The newest one that was to be drawn."""
        self._number = 0
        self._taken_at = 0.0
        self._problem = ""

    def update(self, view: CameraView | None, size: tuple[int, int]) -> None:
        """Show the stream of a view at this size in pixels; both are even. Without a view nothing runs."""
        self._view = view
        wanted = None
        if view is not None and (view.port or view.log) and min(size) >= 2:
            wanted = _Wanted(view.system, view.log, view.stamped, size)
        if wanted != self._wanted:
            self.stop()
            self._wanted = wanted
            if wanted is not None:
                self.output.ask()
                self._problem = ""
                self._task = asyncio.get_running_loop().create_task(self._run(wanted))
        if view is not None and self._recorded is not None:
            self._recorded.show(view.at)

    @property
    def request(self) -> CameraRequest:
        """Return what the station is asked for."""
        return CameraRequest(self._port)

    def report(self) -> None:
        """Tell again that there is a picture."""
        self._on_picture()

    def choose_newest(self) -> None:
        """Show the newest picture from now on: the terminal may have it."""
        if self._shown is not self._picture:
            self._shown = self._picture
            self._number += 1
            self._taken_at = self._find_taken()

    def stop(self) -> None:
        """End the decoder."""
        self._wanted = self._feed = self._recorded = self._picture = self._shown = None
        if self._task is not None:
            self._task.cancel()
            self._task = None

    async def _run(self, wanted: _Wanted) -> None:
        """Decode until it is cancelled."""
        try:
            program = await asyncio.to_thread(find_program)  # it asks ffmpeg for its version, which takes a while
        except SourceError as error:
            self._problem = str(error)
            return
        if wanted.log:
            self._recorded = RecordedFeed(Path(wanted.log), program, self._take, self._on_picture)
            self._recorded.show(self._view.at if self._view is not None else 0.0)
            await self._recorded.run(Shape(*wanted.size, RECORDED_RATE))
        else:
            self._port = _free_port()
            self._feed = Feed(parse_source(f"rtp:{LOOPBACK}:{self._port}", Path()), program, self._take)
            shape = Shape(*wanted.size, RATE)
            await self._feed.run(shape.with_stamp() if wanted.stamped and program.reads_stamps else shape)

    def _take(self, picture: Picture) -> None:
        self._picture = picture
        self._on_picture()

    @property
    def taken_at(self) -> float:
        """When the picture that is shown was taken, as far as is known: without stamps, when it came; 0: none."""
        return 0.0 if self._feed is None or self._shown is None else self._taken_at

    def _find_taken(self) -> float:
        """Return when the newest picture was taken."""
        if self._feed is None:
            return 0.0
        if self._feed.stamp is None or self._view is None or self._view.offset is None:
            return self._feed.new_at
        now = time.monotonic()
        age = (now + self._view.offset - self._feed.stamp) % WRAP
        if age > WRAP / 2:
            age -= WRAP
        return now - age if age >= -CLOCK_ERROR else 0.0

    def state(self) -> PictureState:
        """Return what the picture that is shown is worth."""
        if self._recorded is not None and self._shown is not None and self._recorded.age < math.inf:
            age = self._recorded.age
            return PictureState(Freshness.FRESH if age <= OLDEST_PICTURE else Freshness.LATE, age)
        if self._feed is None or self._shown is None:
            return PictureState(Freshness.NONE)
        came, age = self._feed.state(), max(0.0, time.monotonic() - self.taken_at)
        if age <= OLDEST_PICTURE and came.fresh:
            return PictureState(Freshness.FRESH, age)
        return PictureState(Freshness.LATE if came.fresh else came.freshness, age)

    def value(self, *, ascii: bool, command_age: float | None) -> CameraValue:  # noqa: A002
        """Return what the pane shows now."""
        protocol, level = self.output.protocol(ascii_only=ascii), self.output.level
        state = self.state()
        if state.freshness is Freshness.NONE or self._shown is None:
            word = "NO PICTURE" if self._recorded is not None else "NO PICTURE YET"
            return CameraValue(None, f"{word}: {self._why()}", protocol=protocol)
        word = {Freshness.LATE: "OLD: ", Freshness.FROZEN: "FROZEN: "}.get(state.freshness, "")
        command = "" if command_age is None else f", command {_seconds(command_age)}"
        coarse = f", {level} coarser" if level else ""
        text = f"{word}picture {self._age(state.age)}{command}{coarse}"
        return CameraValue(self._shown, text, not state.fresh, protocol, level, self._number)

    def _age(self, age: float) -> str:
        if self._recorded is not None:
            note = f"; {self._recorded.problem}" if self._recorded.problem else ""
            return f"recorded {_seconds(age)} before this moment{note}"
        exact = self._feed is not None and self._feed.stamp is not None
        if exact and self._view is not None and self._view.offset is not None:
            return f"{_seconds(age)} ±{max(1, round(1000 * self._view.offset_error))} ms"
        return f"{_seconds(age)} since a new one"

    def _why(self) -> str:
        if self._view is None:
            return "waiting for the station"
        if problem := self._problem or self._view.problem:
            return problem
        if self._view.log:
            return (self._recorded.problem if self._recorded is not None else "") or "looking for its pictures"
        if not self._view.port:
            return "asking the vehicle for its camera"
        problem = self._feed.problem if self._feed is not None else ""
        return problem or f"waiting for pictures at UDP port {self._view.port}"


def _seconds(value: float) -> str:
    return f"{min(value, 99.9):.1f} s"


def _free_port() -> int:
    """Return a port of loopback that is free at present, as is the one after it, which decoders open for RTCP."""
    for _ in range(PORT_TRIES):
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as first:
            first.bind((LOOPBACK, 0))
            port: int = first.getsockname()[1]
            if port % 2 == 0 and _is_free(port + 1):
                return port
    return port


def _is_free(port: int) -> bool:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        try:
            probe.bind((LOOPBACK, port))
        except OSError:
            return False
    return True
