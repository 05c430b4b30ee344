"""The simulated camera in real programs: daemon, its process, ffmpeg, and a watcher that decodes what comes."""

from __future__ import annotations

import asyncio
import os
import signal
import time
from pathlib import Path

import pytest
from msgspec.structs import replace

from groundstation.pictures.picture import Picture
from groundstation.video.decoder import find_program
from groundstation.video.feed import Feed
from groundstation.video.ffmpeg_command import Shape
from groundstation.video.source import parse_source
from link.core import Peer
from tests.groundstation.video.ffmpeg_sources import NEEDS_FFMPEG
from tests.ports import free_port
from tests.waits import until
from vehicle.camera.camera import Camera
from vehicle.camera.scene import Pose
from vehicle.camera.settings import SIMULATED_CAMERA, CameraSettings
from vehicle.runtime.camera_link import CameraLink

pytestmark = [pytest.mark.e2e, NEEDS_FFMPEG]
WATCHER = Peer(0, ("127.0.0.1", 14550))


def programs_of(pid: int) -> list[int]:
    """Process ids of the children of a process."""
    text = Path(f"/proc/{pid}/task/{pid}/children").read_text()
    return [int(each) for each in text.split()]


def is_gone(pid: int) -> bool:
    try:
        return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0] == "Z"
    except OSError:
        return True


class Watch:
    """A camera, and a feed of its pictures."""

    def __init__(self, settings: CameraSettings) -> None:
        self.camera = Camera(replace(settings, port=free_port()))
        self.pose = Pose()
        self.ahead = 0.0
        """s by which the clock of the daemon is ahead."""
        self.pictures: list[Picture] = []
        self.link = CameraLink(self.camera, lambda: self.pose)
        source = parse_source(f"rtp:127.0.0.1:{self.camera.settings.port}", Path())
        self.feed = Feed(source, find_program(), self.pictures.append)

    def is_seen(self) -> bool:
        """Let a cycle of the daemon pass; return whether a new picture has come since the last one."""
        now = time.monotonic() + self.ahead
        self.camera.hear(WATCHER, now)
        self.link.update(now)
        seen, self.pictures[:] = bool(self.pictures), []
        return seen

    def has_stopped(self) -> bool:
        self.is_seen()
        return not programs_of(self.link.pid)


def test_pictures_come_while_somebody_watches_whatever_is_killed() -> None:
    async def watch() -> None:
        own = Watch(SIMULATED_CAMERA)
        feeding = asyncio.ensure_future(own.feed.run(Shape(80, 44, 10.0)))
        try:
            assert not programs_of(own.link.pid)
            own.camera.start(WATCHER, time.monotonic())
            await until(own.is_seen)
            await until(own.is_seen)
            (encoder,) = programs_of(own.link.pid)
            os.kill(encoder, signal.SIGKILL)
            await until(lambda: is_gone(encoder))
            await until(lambda: own.is_seen() and programs_of(own.link.pid) != [encoder])
            os.kill(own.link.pid, signal.SIGSTOP)  # the daemon goes on
            began = time.monotonic()
            for number in range(5000):
                own.pose = Pose(north=float(number))
                own.ahead += 1.0
                own.is_seen()
            assert time.monotonic() - began < 2.0
            os.kill(own.link.pid, signal.SIGCONT)
            await until(own.is_seen)
            own.camera.stop(WATCHER)
            await until(own.has_stopped)
            own.camera.start(WATCHER, time.monotonic() + own.ahead)
            await until(lambda: own.is_seen() and programs_of(own.link.pid))
            killed = own.link.pid
            os.kill(killed, signal.SIGKILL)
            await until(lambda: own.is_seen() and own.link.pid != killed and bool(programs_of(own.link.pid)))
            assert own.camera.pop_news()[-1] == "Camera process ended (-9), restart in 1 s"
            (encoder,) = programs_of(own.link.pid)
        finally:
            own.link.close()
            feeding.cancel()
            await asyncio.gather(feeding, return_exceptions=True)
        await until(lambda: is_gone(encoder))

    asyncio.run(watch())


def test_a_command_is_streamed_and_the_fault_of_any_camera_said(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    text = "ffmpeg -loglevel error -re -f lavfi -i testsrc2=size=320x180:rate=10 -c:v libx264 -preset ultrafast"
    words = (*text.split(), "-tune", "zerolatency", "-g", "10", "-f", "h264", "-")

    async def watch(settings: CameraSettings) -> str:
        own = Watch(settings)
        feeding = asyncio.ensure_future(own.feed.run(Shape(80, 44, 10.0)))
        try:
            own.camera.start(WATCHER, time.monotonic())
            await until(lambda: own.is_seen() or bool(own.camera.report.problem))
        finally:
            own.link.close()
            feeding.cancel()
            await asyncio.gather(feeding, return_exceptions=True)
        return own.camera.report.problem

    assert asyncio.run(watch(CameraSettings(kind="command", command=words))) == ""
    absent = CameraSettings(kind="command", command=("no-such-camera",))
    assert "no-such-camera is not installed" in asyncio.run(watch(absent))
    refused = CameraSettings(kind="v4l2", device=str(tmp_path / "video0"))
    assert "video0: No such file" in asyncio.run(watch(refused)), "in ffmpeg's words"
    program = tmp_path / "rpicam-vid"
    program.write_text("#!/bin/sh\necho 'ERROR: *** no cameras available ***' >&2\nexit 255\n")
    program.chmod(0o700)
    monkeypatch.setenv("PATH", f"{tmp_path}:{os.environ['PATH']}")
    assert "no cameras available" in asyncio.run(watch(CameraSettings(kind="rpicam")))
