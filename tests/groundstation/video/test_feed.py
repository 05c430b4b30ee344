"""Feeds of real cameras: ffmpeg sends, ffmpeg decodes, and either is stopped, killed or fed with garbage."""

from __future__ import annotations

import asyncio
import os
import signal
import socket
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from functools import partial
from pathlib import Path

import pytest

from groundstation.pictures.freshness import Freshness
from groundstation.pictures.picture import Picture
from groundstation.video.decoder import MAX_MEMORY, find_program
from groundstation.video.feed import Feed, take_snapshot
from groundstation.video.ffmpeg_command import Shape
from groundstation.video.source import SourceError, parse_source
from tests.groundstation.video.ffmpeg_sources import NEEDS_FFMPEG, camera, record
from tests.ports import free_port
from tests.waits import until

pytestmark = [pytest.mark.e2e, NEEDS_FFMPEG]

SHAPE = Shape(80, 44, 10.0)


class Watcher:
    """A feed, and the pictures that it brought."""

    def __init__(self, text: str, folder: Path, still_after: float = 60.0) -> None:
        self.pictures: list[Picture] = []
        self.feed = Feed(parse_source(text, folder), find_program(), self.pictures.append, still_after=still_after)

    def has_started(self, times: int) -> bool:
        return self.feed.starts == times

    async def more(self, count: int = 3) -> None:
        seen = len(self.pictures)
        await until(lambda: len(self.pictures) >= seen + count)
        assert {(each.width, each.height, len(each.rgb)) for each in self.pictures} == {(80, 44, SHAPE.size)}


@asynccontextmanager
async def watching(text: str, folder: Path = Path(), still_after: float = 60.0) -> AsyncIterator[Watcher]:
    watcher = Watcher(text, folder, still_after)
    running = asyncio.ensure_future(watcher.feed.run(SHAPE))
    try:
        yield watcher
    finally:
        running.cancel()
        await asyncio.gather(running, return_exceptions=True)
        decoder = watcher.feed.decoder
        assert decoder is None or not exists(decoder.pid)


def has_bars(picture: Picture) -> bool:
    """Whether it is the test picture: its bars are red, green, yellow, blue, magenta, cyan; things move before them."""
    bars = [(1, 0, 0), (0, 1, 0), (1, 1, 0), (0, 0, 1), (1, 0, 1), (0, 1, 1)]
    rows = map(picture.row, range(picture.height))
    return any(
        [tuple(part > 128 for part in row[3 * x : 3 * x + 3]) for x in (6, 20, 33, 45, 58, 74)] == bars for row in rows
    )


def exists(pid: int) -> bool:
    return Path(f"/proc/{pid}").exists()


def memory_limit(pid: int) -> str:
    lines = Path(f"/proc/{pid}/limits").read_text().splitlines()
    return next(line for line in lines if "address space" in line)


@pytest.mark.parametrize("kind", ["rtp", "udp", "http"])
async def test_a_camera_that_comes_goes_and_comes_again(kind: str) -> None:
    port = free_port()
    text = f"http://127.0.0.1:{port}/" if kind == "http" else f"{kind}:127.0.0.1:{port}"
    with camera(kind, port) as first:
        async with watching(text) as watcher:
            await watcher.more()
            assert has_bars(watcher.pictures[-1])
            assert watcher.feed.state().fresh
            os.kill(first.pid, signal.SIGSTOP)
            await until(lambda: watcher.feed.state().freshness is Freshness.LATE)
            os.kill(first.pid, signal.SIGCONT)
            await watcher.more()
            first.kill()
            first.wait()
            await until(lambda: not watcher.feed.state().fresh)
            with camera(kind, port, "testsrc2=size=640x480:rate=15"):  # another size and other proportions
                await watcher.more()


async def test_a_decoder_that_is_stopped_or_killed_is_started_again() -> None:
    port = free_port()
    with camera("udp", port):
        async with watching(f"udp:127.0.0.1:{port}", still_after=3.0) as watcher:
            for number, sent in ((2, signal.SIGKILL), (3, signal.SIGSTOP)):
                await watcher.more()
                assert watcher.feed.decoder is not None
                stopped = watcher.feed.decoder.pid
                os.kill(stopped, sent)
                await until(lambda: not watcher.feed.state().fresh)
                await until(partial(watcher.has_started, number))
                assert not exists(stopped)
            await watcher.more()
            assert watcher.feed.problem == ""


async def test_garbage_and_huge_pictures_end_no_feed() -> None:
    port = free_port()
    with camera("udp", port), socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as stranger:
        async with watching(f"udp:127.0.0.1:{port}") as watcher:
            await watcher.more()
            for _ in range(500):
                stranger.sendto(os.urandom(1200), ("127.0.0.1", port))
            await watcher.more()
            assert watcher.feed.decoder is not None
            assert str(MAX_MEMORY) in memory_limit(watcher.feed.decoder.pid)


async def test_a_frozen_camera_is_said() -> None:
    port = free_port()
    with camera("udp", port, "color=red:size=320x180:rate=15"):
        async with watching(f"udp:127.0.0.1:{port}") as watcher:
            await until(lambda: watcher.feed.state().freshness is Freshness.FROZEN)
            assert len(watcher.pictures) == 1


async def test_recordings_end_and_what_is_none_is_refused(tmp_path: Path) -> None:
    record(tmp_path / "drive.mp4", "testsrc2=size=320x180:rate=10:duration=0.5", "-c:v", "libx264")
    record(tmp_path / "8k.avi", "color=red:size=7680x4320:rate=1:duration=1", "-c:v", "mjpeg")
    (tmp_path / "list.mp4").write_text("#EXTM3U\n#EXT-X-TARGETDURATION:1\n#EXTINF:1,\ndrive.mp4\n#EXT-X-ENDLIST\n")
    (tmp_path / "text.mp4").write_text("ffconcat version 1.0\nfile drive.mp4\n")
    (tmp_path / "noise.mp4").write_bytes(os.urandom(100_000))
    assert has_bars(await take_snapshot(parse_source("drive.mp4", tmp_path), find_program(), SHAPE, 60.0))
    for name, brought in (("drive.mp4", 5), ("8k.avi", 0), ("list.mp4", 0), ("text.mp4", 0), ("noise.mp4", 0)):
        watcher = Watcher(name, tmp_path)
        await asyncio.wait_for(watcher.feed.run(SHAPE), 60.0)
        assert watcher.feed.ended
        assert (len(watcher.pictures) > 0) is (brought > 0), name
        assert watcher.feed.problem
        assert watcher.feed.problem.isprintable()
    with pytest.raises(SourceError, match="no picture within"):
        await take_snapshot(parse_source("noise.mp4", tmp_path), find_program(), SHAPE, 60.0)
