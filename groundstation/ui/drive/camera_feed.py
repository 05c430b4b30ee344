"""The camera of the Drive screen: decodes the stream that the station has found, while a pane shows it."""

from __future__ import annotations

import asyncio
import os
import time
from collections.abc import Callable
from pathlib import Path

import msgspec

from groundstation.intents.driving import CLOCK_ERROR, OLDEST_PICTURE
from groundstation.pictures.budget import LOCAL_BYTES, REMOTE_BYTES
from groundstation.pictures.freshness import Freshness, PictureState
from groundstation.pictures.picture import Picture
from groundstation.video.decoder import find_program
from groundstation.video.feed import Feed
from groundstation.video.ffmpeg_command import MIN_STAMPED_WIDTH, Shape
from groundstation.video.source import SourceError, parse_source
from groundstation.views.camera import CameraView

RATE = 30.0
"""Pictures a second at most that are decoded: each tells how old the picture is. Fewer are drawn."""
DRAW_PERIOD = 0.1
"""s between two pictures that are drawn, at least."""
CELL_BYTES = 25
"""Bytes of a cell of a picture, all of whose cells have changed."""
WRAP = 2**32 / 1000
"""s after which a stamp begins again at 0."""


class CameraValue(msgspec.Struct, frozen=True):
    """What the pane shows."""

    picture: Picture | None = None
    text: str = "waiting for the station"
    grey: bool = True
    ascii: bool = False


class CameraFeed:
    """One stream at a time. Times are those of the monotonic clock that station and screen have in common."""

    def __init__(self, on_picture: Callable[[], None]) -> None:
        self._on_picture = on_picture
        self._view: CameraView | None = None
        self._feed: Feed | None = None
        self._task: asyncio.Task[None] | None = None
        self._wanted: tuple[int, Shape] | None = None
        self._picture: Picture | None = None
        self._problem = ""
        self._draw_at = 0.0
        self._limit = REMOTE_BYTES if os.environ.get("SSH_CONNECTION") else LOCAL_BYTES

    def update(self, view: CameraView | None, size: tuple[int, int]) -> None:
        """Show the stream of a view at this size in pixels; both are even. Without a view nothing runs."""
        self._view = view
        wanted = None
        if view is not None and view.port and min(size) >= 2:
            wanted = view.port, Shape(*size, RATE, view.stamped and size[0] >= MIN_STAMPED_WIDTH)
        if wanted != self._wanted:
            self.stop()
            self._wanted = wanted
            if wanted is not None:
                self._start(*wanted)

    def is_draw_due(self, cells: int) -> bool:
        """Return whether a picture of so many cells may be drawn now: bytes a second to the terminal are bounded."""
        now = time.monotonic()
        if now < self._draw_at:
            return False
        self._draw_at = now + max(DRAW_PERIOD, cells * CELL_BYTES / self._limit)
        return True

    def stop(self) -> None:
        """End the decoder."""
        self._wanted = self._feed = self._picture = None
        if self._task is not None:
            self._task.cancel()
            self._task = None

    def _start(self, port: int, shape: Shape) -> None:
        self._problem = ""
        try:
            source, program = parse_source(f"rtp:{port}", Path()), find_program()
        except SourceError as error:
            self._problem = str(error)
            return
        self._feed = Feed(source, program, self._take)
        self._task = asyncio.get_running_loop().create_task(self._feed.run(shape))

    def _take(self, picture: Picture) -> None:
        self._picture = picture
        self._on_picture()

    @property
    def taken_at(self) -> float:
        """When the newest picture was taken, as far as is known: of a stream without stamps, when it came; 0: none."""
        if self._feed is None or self._picture is None:
            return 0.0
        if self._feed.stamp is None or self._view is None or self._view.offset is None:
            return self._feed.new_at
        now = time.monotonic()
        age = (now + self._view.offset - self._feed.stamp) % WRAP
        if age > WRAP / 2:
            age -= WRAP
        return now - age if age >= -CLOCK_ERROR else 0.0

    def state(self) -> PictureState:
        """Return what the newest picture is worth."""
        if self._feed is None or self._picture is None:
            return PictureState(Freshness.NONE)
        came, age = self._feed.state(), max(0.0, time.monotonic() - self.taken_at)
        if age <= OLDEST_PICTURE and came.fresh:
            return PictureState(Freshness.FRESH, age)
        return PictureState(Freshness.LATE if came.fresh else came.freshness, age)

    def value(self, *, ascii: bool, command_age: float | None) -> CameraValue:  # noqa: A002
        """Return what the pane shows now."""
        state = self.state()
        if state.freshness is Freshness.NONE or self._picture is None:
            return CameraValue(None, f"NO PICTURE YET: {self._why()}", ascii=ascii)
        word = {Freshness.LATE: "OLD: ", Freshness.FROZEN: "FROZEN: "}.get(state.freshness, "")
        command = "" if command_age is None else f", command {_seconds(command_age)}"
        return CameraValue(self._picture, f"{word}picture {self._age(state.age)}{command}", not state.fresh, ascii)

    def _age(self, age: float) -> str:
        exact = self._feed is not None and self._feed.stamp is not None
        if exact and self._view is not None and self._view.offset is not None:
            return f"{_seconds(age)} ±{max(1, round(1000 * self._view.offset_error))} ms"
        return f"{_seconds(age)} since a new one"

    def _why(self) -> str:
        if self._view is None:
            return "waiting for the station"
        if problem := self._problem or self._view.problem:
            return problem
        if not self._view.port:
            return "asking the vehicle for its camera"
        problem = self._feed.problem if self._feed is not None else ""
        return problem or f"waiting for pictures at UDP port {self._view.port}"


def _seconds(value: float) -> str:
    return f"{min(value, 99.9):.1f} s"
