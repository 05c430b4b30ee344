"""Pictures by gst-launch-1.0, which is used where ffmpeg is missing. The cameras are ffmpeg's test source."""

from __future__ import annotations

import asyncio
import os
import shutil
import signal
import subprocess
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from functools import cache
from pathlib import Path

import pytest

from groundstation.pictures.picture import Picture
from groundstation.video.decoder import DecoderProgram
from groundstation.video.feed import Feed
from groundstation.video.ffmpeg_command import Shape
from groundstation.video.gst_command import build_gst_command
from groundstation.video.source import parse_source
from tests.groundstation.video.ffmpeg_sources import NEEDS_FFMPEG, camera, record
from tests.groundstation.video.test_feed import has_bars
from tests.ports import free_port
from tests.waits import until

SHAPE = Shape(80, 44, 10.0)
ELEMENTS = ("avdec_h264", "rtph264depay", "souphttpsrc", "multipartdemux", "jpegdec", "qtdemux")
GST = shutil.which("gst-launch-1.0")


@cache
def has_gst() -> bool:
    """Whether GStreamer and the plugins of these sources are installed."""
    inspect = shutil.which("gst-inspect-1.0")
    return (
        GST is not None
        and inspect is not None
        and all(subprocess.run([inspect, "--exists", each], check=False).returncode == 0 for each in ELEMENTS)
    )


pytestmark = [pytest.mark.e2e, NEEDS_FFMPEG, pytest.mark.skipif(not has_gst(), reason="GStreamer is not installed")]


class Watcher:
    """A feed by gst-launch, and its pictures."""

    def __init__(self, text: str, folder: Path = Path()) -> None:
        assert GST is not None
        self.pictures: list[Picture] = []
        program = DecoderProgram(GST, build_gst_command, reads_stamps=False)
        self.feed = Feed(parse_source(text, folder), program, self.pictures.append, still_after=5.0)

    async def more(self) -> None:
        """Wait until new pictures have come, whole ones with the bars."""
        seen = len(self.pictures)
        await until(lambda: len(self.pictures) > seen + 3 and has_bars(self.pictures[-1]))


@asynccontextmanager
async def watching(text: str) -> AsyncIterator[Watcher]:
    watcher = Watcher(text)
    feeding = asyncio.ensure_future(watcher.feed.run(SHAPE))
    try:
        yield watcher
    finally:
        feeding.cancel()
        await asyncio.gather(feeding, return_exceptions=True)


@pytest.mark.parametrize("kind", ["rtp", "http"])
async def test_a_camera_that_goes_comes_again_with_another_size(kind: str) -> None:
    port = free_port()
    text = f"http://127.0.0.1:{port}/" if kind == "http" else f"{kind}:127.0.0.1:{port}"
    with camera(kind, port) as first:
        async with watching(text) as watcher:
            await watcher.more()
            first.kill()
            first.wait()
            await until(lambda: not watcher.feed.state().fresh)
            with camera(kind, port, "testsrc2=size=640x360:rate=15"):
                await watcher.more()
                assert watcher.feed.decoder is not None
                os.kill(watcher.feed.decoder.pid, signal.SIGSTOP if kind == "rtp" else signal.SIGKILL)
                await until(lambda: not watcher.feed.state().fresh)
                if kind == "rtp":  # a server of ffmpeg ends with its client
                    await watcher.more()


async def test_a_recording_is_shown_once(tmp_path: Path) -> None:
    record(tmp_path / "drive.mp4", "testsrc2=size=320x180:rate=10:duration=1", "-c:v", "libx264")
    (tmp_path / "noise.mp4").write_bytes(os.urandom(100_000))
    for name, shown in (("drive.mp4", True), ("noise.mp4", False)):
        watcher = Watcher(name, tmp_path)
        await asyncio.wait_for(watcher.feed.run(SHAPE), 60.0)
        assert watcher.feed.ended
        assert any(map(has_bars, watcher.pictures)) is shown
        assert watcher.feed.problem.isprintable()
