"""The recorded picture of a moment: decodes from the key picture before it, and goes on while the moment moves on.

One decoder reads from a pipe what is asked for, also backwards: with each key picture it begins anew.
"""

from __future__ import annotations

import asyncio
import contextlib
import math
import time
from collections.abc import Callable
from pathlib import Path

from groundstation.pictures.picture import Picture
from groundstation.stream.recorded_video import RecordedVideo
from groundstation.video.decoder import Decoder, DecoderEndedError, DecoderProgram, running_decoder
from groundstation.video.ffmpeg_command import Shape, split_picture
from groundstation.video.source import RECORDED
from link.transport.backoff import Backoff

END_OF_UNIT = b"\0\0\0\1\x09\xf0"
"""An access unit delimiter: the unit before it is whole."""
AHEAD = 1
"""Pictures that the decoder gets beyond the moment: it gives one when it sees the next one."""
LATER = "they begin later in the log"
LOOK_AGAIN = 1.0
"""s after which a file is read again that may have grown."""


class RecordedFeed:
    """The picture beside a log. `on_picture` is called for each that was decoded, in the event loop.

    `on_change` is called when what is said of it has changed.
    """

    def __init__(
        self, log: Path, program: DecoderProgram, on_picture: Callable[[Picture], None], on_change: Callable[[], None]
    ) -> None:
        self.problem = ""
        """Why there is no picture, or not each, in one line."""
        self.age = math.inf
        """s from the picture that is shown to the moment."""
        self._video = RecordedVideo(log)
        self._program, self._on_picture, self._on_change = program, on_picture, on_change
        self._said: object = None
        self._at = 0
        self._moved = asyncio.Event()
        self._fed: int | None = None
        """The last picture that the decoder has."""
        self._refresh_at = 0.0

    def show(self, at: float) -> None:
        """Show the picture of a moment, s since 1970."""
        microseconds = round(at * 1e6)
        if microseconds != self._at:
            self._at = microseconds
            self._moved.set()

    async def run(self, shape: Shape) -> None:
        """Bring pictures of this shape until it is cancelled."""
        backoff = Backoff()
        try:
            while True:
                try:
                    await self._follow(shape)
                except (OSError, DecoderEndedError) as error:
                    self.problem = str(error) or "the decoder has ended"
                await asyncio.sleep(backoff.next_delay())
        finally:
            self._video.close()

    async def _follow(self, shape: Shape) -> None:
        """Decode until the kind of the pictures changes. Raises OSError, DecoderEndedError."""
        number = await self._next()
        self._fed = None
        stamped = self._video.is_stamped(number)
        given = shape.with_stamp() if stamped and self._program.reads_stamps else shape
        words = self._program.build(self._program.path, RECORDED, given)
        async with running_decoder(words, given, fed=True) as decoder:
            reading = asyncio.ensure_future(self._read(decoder, given))
            try:
                while self._video.is_stamped(number) == stamped and not reading.done():
                    await self._feed(decoder, number)
                    number = await self._next()
            finally:
                reading.cancel()
                await asyncio.gather(reading, return_exceptions=True)
            if reading.done() and not reading.cancelled():
                reading.result()

    async def _next(self) -> int:
        """Wait until there is a picture for the moment, and it is another one than before."""
        while True:
            if time.monotonic() >= self._refresh_at:
                await asyncio.to_thread(self._video.refresh)
                self._refresh_at = time.monotonic() + LOOK_AGAIN
                self.problem = self._video.problem
            number = self._video.find(self._at)
            self.age = math.inf if number is None else (self._at - self._video.time(number)) / 1e6
            if number is None and self.problem in ("", LATER):
                self.problem = LATER
            elif self.problem == LATER:
                self.problem = ""
            self._tell((self.problem, self.age))
            if number is not None and (self._fed is None or self._wanted(number) != self._fed):
                return number
            self._moved.clear()
            with contextlib.suppress(TimeoutError):
                await asyncio.wait_for(self._moved.wait(), LOOK_AGAIN)

    def _tell(self, said: object) -> None:
        if said != self._said:
            self._said = said
            self._on_change()

    def _wanted(self, number: int) -> int:
        return min(number + AHEAD, len(self._video) - 1)

    async def _feed(self, decoder: Decoder, number: int) -> None:
        """Give the decoder what it needs for a picture."""
        last, key = self._wanted(number), self._video.key_before(number)
        goes_on = self._fed is not None and key <= self._fed + 1 <= last
        first = self._fed + 1 if goes_on and self._fed is not None else key
        for each in range(first, last + 1):
            await decoder.write(self._video.read(each) + END_OF_UNIT)
        self._fed = last

    async def _read(self, decoder: Decoder, shape: Shape) -> None:
        while True:
            self._on_picture(split_picture(shape, await decoder.read())[0])
