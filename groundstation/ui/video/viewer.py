"""The viewer: shows a feed in the terminal until a key ends it. The newest picture counts, older ones are dropped."""

from __future__ import annotations

import asyncio
import os
import signal
import time
from collections import deque

import msgspec

from groundstation.pictures.budget import LOCAL_BYTES, REMOTE_BYTES, ByteBudget
from groundstation.pictures.painters import BEGIN_UPDATE, END_UPDATE, PAINTERS, Area
from groundstation.pictures.picture import Picture
from groundstation.pictures.protocol import Protocol, choose_protocol
from groundstation.ui.terminal.tty_output import TerminalFile
from groundstation.ui.video.picture_terminal import TICK, PictureTerminal
from groundstation.ui.video.status_line import format_status
from groundstation.video.decoder import DecoderProgram
from groundstation.video.feed import Feed
from groundstation.video.ffmpeg_command import Shape
from groundstation.video.source import VideoSource

SETTLED_AFTER = 1.0
"""s after the last change of the terminal's size, after which the decoder is started again for it."""
STATUS_PERIOD = 0.2
"""s between two drawings of the line below the picture: it shows tenths of a second."""
RATE_WINDOW = 2.0
"""s over which pictures are counted."""


class ViewerOptions(msgspec.Struct, frozen=True):
    """What the command line says."""

    protocol: Protocol | None = None
    """None: as the terminal can."""
    rate: float = 10.0
    """Pictures a second at most."""
    limit: int | None = None
    """Bytes a second to the terminal; None: by where the terminal is."""
    ascii_only: bool = False


class Viewer:
    """Draws what a feed brings."""

    def __init__(
        self, source: VideoSource, program: DecoderProgram, options: ViewerOptions, file: TerminalFile
    ) -> None:
        self._options = options
        self._ended = asyncio.Event()
        self._terminal = PictureTerminal(file, self._ended.set, self._handle_pong)
        self._feed = Feed(source, program, self._take)
        self._newest: Picture | None = None
        self._drawn_at: deque[float] = deque(maxlen=256)
        self._grey = self._dirty = False
        self._status_at = self._resized_at = 0.0
        self._area = Area(2, 2)
        self._protocol = options.protocol or Protocol.ASCII
        self._painter = PAINTERS[self._protocol]()
        self._budget = ByteBudget(LOCAL_BYTES)

    async def run(self) -> None:
        """Show pictures until a key, a signal or the end of the terminal."""
        loop = asyncio.get_running_loop()
        for number in (signal.SIGTERM, signal.SIGHUP, signal.SIGINT):
            loop.add_signal_handler(number, self._ended.set)
        with self._terminal.opened():
            await self._terminal.ask()
            self._prepare()
            try:
                await self._show()
            finally:
                self._terminal.write(self._painter.clear())

    def _prepare(self) -> None:
        """Choose how to draw."""
        options, answers = self._options, self._terminal.answers
        self._protocol = options.protocol or choose_protocol(answers, os.environ, ascii_only=options.ascii_only)
        self._painter = PAINTERS[self._protocol]()
        remote = bool(os.environ.get("SSH_CONNECTION"))
        self._budget = ByteBudget(
            options.limit or (REMOTE_BYTES if remote else LOCAL_BYTES), round_trip=self._terminal.round_trip
        )
        self._area = self._terminal.area()

    async def _show(self) -> None:
        feeding = self._start_feed()
        try:
            while not self._ended.is_set():
                if self._settle_size(time.monotonic()):
                    feeding.cancel()
                    await asyncio.gather(feeding, return_exceptions=True)
                    feeding = self._start_feed()
                self._terminal.tick()
                self._draw(time.monotonic())
                await self._wait()
        finally:
            feeding.cancel()
            await asyncio.gather(feeding, return_exceptions=True)

    async def _wait(self) -> None:
        try:
            await asyncio.wait_for(self._ended.wait(), TICK)
        except TimeoutError:
            return

    def _start_feed(self) -> asyncio.Task[None]:
        width, height = self._painter.fit(self._area)
        return asyncio.ensure_future(self._feed.run(Shape(width, height, self._options.rate)))

    def _settle_size(self, now: float) -> bool:
        """Return whether the decoder must be started again for a size of the terminal that has settled."""
        area = self._terminal.area()
        if area != self._area:
            self._area, self._resized_at, self._dirty = area, now, True
            self._terminal.write(f"\x1b[0m\x1b[2J{self._painter.clear()}")
        if not self._resized_at or now - self._resized_at < SETTLED_AFTER:
            return False
        self._resized_at = 0.0
        return True

    def _take(self, picture: Picture) -> None:
        self._newest, self._dirty = picture, True
        self._draw(time.monotonic())

    def _handle_pong(self) -> None:
        self._budget.handle_pong(time.monotonic())

    def _draw(self, now: float) -> None:
        """Draw the newest picture, if it is new and the terminal takes it, and the line below it."""
        if self._terminal.busy:
            return
        state = self._feed.state()
        self._dirty |= state.fresh is self._grey
        picture, text = self._newest, ""
        if picture is not None and self._dirty and self._budget.may_draw(now):
            self._grey, self._dirty = not state.fresh, False
            shown = picture.greyed() if self._grey else picture
            text = self._painter.paint(shown, self._area, self._budget.level)
            self._drawn_at.append(now)
        if text or now - self._status_at >= STATUS_PERIOD:
            self._status_at = now
            rate = sum(now - at < RATE_WINDOW for at in self._drawn_at) / RATE_WINDOW
            line = format_status(
                self._feed.source.name, state, rate, self._protocol, self._budget.level, self._feed.problem,
                self._area.columns,
            )  # fmt: skip
            text = f"{BEGIN_UPDATE}{text}\x1b[{self._area.rows + 1};1H{line}{END_UPDATE}"
            self._write(text, now)

    def _write(self, text: str, now: float) -> None:
        if self._budget.may_draw(now):
            self._budget.note_frame(len(text.encode()), now)
            self._terminal.write_frame(text)
