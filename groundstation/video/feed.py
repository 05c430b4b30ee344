"""A feed: the newest picture of a source. Its decoder is started again after it has ended or stands still."""

from __future__ import annotations

import asyncio
import time
from collections.abc import Callable
from typing import Any

from groundstation.pictures.freshness import PictureAge, PictureState
from groundstation.pictures.picture import Picture
from groundstation.video.decoder import Decoder, DecoderEndedError, DecoderProgram, running_decoder
from groundstation.video.ffmpeg_command import Shape, split_picture
from groundstation.video.source import SourceError, VideoSource
from link.transport.backoff import Backoff

STILL_AFTER = 15.0
"""s without a picture after which the decoder is killed and started again: a camera may send a whole one each 10 s."""
GOOD_AFTER = 10.0
"""s that a decoder must run for the next fault to count as a first one."""


class Feed:
    """Pictures of one source, the newest only. `on_picture` is called for each new one, in the event loop."""

    def __init__(
        self,
        source: VideoSource,
        program: DecoderProgram,
        on_picture: Callable[[Picture], None] = lambda _: None,
        *,
        still_after: float = STILL_AFTER,
    ) -> None:
        self.source = source
        self.problem = ""
        """Why there is no picture, in one line."""
        self.ended = False
        """A recording is at its end."""
        self.starts = 0
        """How often a decoder was started."""
        self.stamp: float | None = None
        """s in the newest picture, if the shape says that it has a stamp."""
        self.decoder: Decoder | None = None
        """The one that runs."""
        self._program, self._on_picture, self._still_after = program, on_picture, still_after
        self._age = PictureAge()
        self._backoff = Backoff()

    def state(self) -> PictureState:
        """Return what the newest picture is worth now."""
        return self._age.judge(time.monotonic())

    @property
    def new_at(self) -> float:
        """When the newest picture came, by the monotonic clock."""
        return self._age.new_at

    async def run(self, shape: Shape) -> None:
        """Bring pictures of this shape until it is cancelled, or a recording has ended."""
        while not self.ended:
            began = time.monotonic()
            self.starts += 1
            try:
                await self._decode(shape)
            except (OSError, DecoderEndedError) as error:
                self.problem = str(error) or "the source has ended"
                self.ended = self.source.ends
            except TimeoutError:
                self.problem = f"nothing came for {self._still_after:g} s: the decoder was started again"
            if self.ended:
                return
            if time.monotonic() - began > GOOD_AFTER:
                self._backoff.reset()
            await asyncio.sleep(self._backoff.next_delay())

    async def _decode(self, shape: Shape) -> None:
        words = self._program.build(self._program.path, self.source, shape)
        async with running_decoder(words, shape) as decoder:
            self.decoder = decoder
            while True:
                async with asyncio.timeout(self._still_after):
                    rgb = await decoder.read()
                self._take(*split_picture(shape, rgb))

    def _take(self, picture: Picture, stamp: float | None) -> None:
        self.problem, self.stamp = "", stamp
        if self._age.note(picture, time.monotonic(), stamp):
            self._on_picture(picture)


async def take_snapshot(source: VideoSource, program: DecoderProgram, shape: Shape, within: float) -> Picture:
    """Return the first picture of a source. Raises SourceError after `within` s."""
    found: asyncio.Future[Picture] = asyncio.get_running_loop().create_future()
    feed = Feed(source, program, lambda picture: None if found.done() else found.set_result(picture))
    feeding = asyncio.ensure_future(feed.run(shape))
    tasks: list[asyncio.Future[Any]] = [feeding, found]
    try:
        await asyncio.wait(tasks, timeout=within, return_when=asyncio.FIRST_COMPLETED)
    finally:
        feeding.cancel()
        await asyncio.gather(feeding, return_exceptions=True)
    if not found.done():
        raise SourceError(f"{source.name}: no picture within {within:g} s{f': {feed.problem}' if feed.problem else ''}")
    return found.result()
