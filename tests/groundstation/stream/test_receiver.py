"""A stream in real programs: received once, shown on two screens, recorded, and shown again at the times of the log."""

from __future__ import annotations

import asyncio
import os
import signal
import subprocess
import time
from functools import partial
from pathlib import Path

import pytest

from groundstation.pictures.picture import Picture
from groundstation.stream.names import find_parts
from groundstation.stream.orders import StreamOrders
from groundstation.stream.receiver_link import ReceiverLink
from groundstation.stream.recorded_video import RecordedVideo
from groundstation.video.decoder import find_program
from groundstation.video.feed import Feed
from groundstation.video.ffmpeg_command import Shape
from groundstation.video.recorded_feed import RecordedFeed
from groundstation.video.source import parse_source
from link.tlog.recorder import unix_offset
from tests.groundstation.video.ffmpeg_sources import NEEDS_FFMPEG, camera
from tests.ports import free_port
from tests.waits import until

pytestmark = [pytest.mark.e2e, NEEDS_FFMPEG]
SHAPE = Shape(80, 44, 30.0)
RECORDED = 45
"""Pictures of the recording: three key pictures at least."""


class Session:
    """A station's end, and two screens."""

    def __init__(self, folder: Path) -> None:
        self.log = folder / "2026-11-28_09-00-00.tlog"
        self.link = ReceiverLink(100)
        ports = [free_port() for _ in range(4)]
        self.screens = ports[0], ports[2]  # a decoder opens the next port, too
        self.orders = StreamOrders(free_port(), self.screens, log=str(self.log), offset=unix_offset())
        self.seen: dict[int, Picture] = {}
        self.feeds = [
            Feed(parse_source(f"rtp:127.0.0.1:{port}", Path()), find_program(), partial(self._see, port))
            for port in self.screens
        ]

    def _see(self, port: int, picture: Picture) -> None:
        self.seen[port] = picture

    def both_see(self) -> bool:
        self.link.update(self.orders, time.monotonic())
        return len(self.seen) == len(self.screens)

    def has_recorded(self, count: int) -> bool:
        self.link.update(self.orders, time.monotonic())
        video = RecordedVideo(self.log)
        video.refresh()
        found = len(video)
        video.close()
        return found >= count


async def record(session: Session) -> None:
    """Record some pictures; in between the process is killed."""
    feeding = [asyncio.ensure_future(feed.run(SHAPE)) for feed in session.feeds]
    try:
        with camera("rtp", session.orders.port):
            await until(session.both_see)
            await until(lambda: session.has_recorded(RECORDED))
            assert session.link.pid is not None
            os.kill(session.link.pid, signal.SIGKILL)
            await until(lambda: session.link.starts == 2 or session.both_see() is None)
            session.seen.clear()
            await until(session.both_see)
            await until(lambda: len(find_parts(session.log)) == 2 and session.has_recorded(2 * RECORDED))
            recorded = find_parts(session.log)[1]
            assert recorded.stat().st_mode & 0o777 == 0o600
            await until(lambda: session.link.report.recorded == str(recorded) or session.both_see() is None)
    finally:
        for each in feeding:
            each.cancel()
        await asyncio.gather(*feeding, return_exceptions=True)
        session.link.close()


def is_whole(path: Path) -> bool:
    """Other programs read the file without a complaint."""
    words = ["ffmpeg", "-nostdin", "-v", "error", "-xerror", "-i", str(path), "-f", "null", "-"]
    done = subprocess.run(words, capture_output=True, stdin=subprocess.DEVNULL, check=False)
    return done.returncode == 0 and not done.stderr


async def show_again(log: Path) -> None:
    """At the same moment is the same picture, whatever was shown before."""
    video = RecordedVideo(log)
    video.refresh()
    times = [video.time(number) / 1e6 for number in range(len(video))]
    shown: list[Picture] = []
    feed = RecordedFeed(log, find_program(), shown.append, lambda: None)
    feed.show(times[0] - 10)
    showing = asyncio.ensure_future(feed.run(SHAPE))

    async def picture_at(number: int) -> bytes:
        shown.clear()
        feed.show(times[number] + 0.001)
        await until(lambda: shown and feed.age < 0.1)
        newest = None
        while newest is not shown[-1]:
            newest = shown[-1]
            await asyncio.sleep(0.3)  # no picture follows: the moment stands still
        return shown[-1].rgb

    try:
        await until(lambda: feed.problem == "they begin later in the log")
        first, second, third = [await picture_at(number) for number in (3, 20, 37)]
        assert len({first, second, third}) == 3
        assert [await picture_at(number) for number in (20, 3, 37)] == [second, first, third]
        feed.show(times[RECORDED // 2] + 0.001)
        await until(lambda: feed.age < 0.1)
        feed.show(times[-1] + 100)
        await until(lambda: 99 < feed.age < 101)
    finally:
        showing.cancel()
        await asyncio.gather(showing, return_exceptions=True)
        video.close()


def test_pictures_are_recorded_and_shown_in_step(tmp_path: Path) -> None:
    async def run() -> None:
        session = Session(tmp_path)
        began = time.time()
        await record(session)
        video = RecordedVideo(session.log)
        video.refresh()
        assert (video.damaged, video.problem) == (0, "")
        assert began < video.time(0) / 1e6 < video.time(len(video) - 1) / 1e6 < time.time()
        video.close()
        assert all(is_whole(path) for path in find_parts(session.log))
        await show_again(session.log)

    asyncio.run(run())


def test_a_port_that_another_program_has_is_named(tmp_path: Path) -> None:
    async def run() -> None:
        first, second, port = ReceiverLink(100), ReceiverLink(100), free_port()
        try:

            def refused() -> bool:
                first.update(StreamOrders(port), time.monotonic())
                second.update(StreamOrders(port), time.monotonic())
                return f"UDP port {port}: Address already in use" in first.report.problem + second.report.problem

            await until(refused)
        finally:
            first.close()
            second.close()

    asyncio.run(run())
