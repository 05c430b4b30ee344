"""The camera of Drive with real programs: what stops the pictures locks the keys, and fresh ones unlock them."""

from __future__ import annotations

import asyncio
import contextlib
import os
import signal
import time

import pytest
from msgspec.structs import replace

from groundstation.intents.driving import OLDEST_PICTURE, DriveByPicture
from groundstation.pictures.freshness import Freshness
from groundstation.station.driving.picture_lock import PictureLock
from groundstation.stream.orders import StreamOrders
from groundstation.stream.receiver_link import ReceiverLink
from groundstation.ui.drive.camera_feed import CameraFeed
from groundstation.views.camera import CameraView
from link.core import Peer
from tests.groundstation.video.ffmpeg_sources import NEEDS_FFMPEG, camera
from tests.ports import free_port
from tests.vehicle.camera.test_process import programs_of
from tests.waits import until
from vehicle.camera.camera import Camera
from vehicle.camera.settings import SIMULATED_CAMERA
from vehicle.runtime.camera_link import CameraLink

pytestmark = [pytest.mark.e2e, NEEDS_FFMPEG]
WATCHER = Peer(0, ("127.0.0.1", 14550))
LATE = 1.0
"""s by which a loaded machine may notice late."""


class Drive:
    """A simulated camera, the feed of the Drive screen, and the lock of a station."""

    def __init__(self) -> None:
        self.camera = Camera(replace(SIMULATED_CAMERA, port=free_port()))
        self.link = CameraLink(self.camera)
        self.receiver = ReceiverLink(100)
        self.feed = CameraFeed(self._report)
        self.lock = PictureLock()
        self.view = CameraView(1, self.camera.settings.port, stamped=True, offset=0.0, offset_error=0.001)

    def _report(self) -> None:
        self.feed.choose_newest()
        self.lock.handle(DriveByPicture(drives=True, taken_at=self.feed.taken_at), time.monotonic())

    def _live(self) -> None:
        now = time.monotonic()
        self.camera.hear(WATCHER, now)
        self.link.update(now)
        self.feed.update(self.view, (80, 44))
        screens = (self.feed.request.port,) if self.feed.request.port else ()
        self.receiver.update(StreamOrders(self.view.port, screens, stamped=True), now)

    def drives(self) -> bool:
        self._live()
        return self.lock.ends_at is not None and self.lock.refusal(time.monotonic()) is None

    def locked(self) -> bool:
        return not self.drives()

    @property
    def encoder(self) -> int:
        [found] = programs_of(self.link.pid)
        return found

    @property
    def receiving(self) -> int:
        assert self.receiver.pid is not None
        return self.receiver.pid

    @property
    def decoder(self) -> int:
        assert self.feed._feed is not None
        assert self.feed._feed.decoder is not None
        return self.feed._feed.decoder.pid


async def lasts(drive: Drive) -> None:
    """Fresh pictures keep coming."""
    await until(drive.drives)
    seen = drive.feed.taken_at
    await until(lambda: drive.drives() and drive.feed.taken_at > seen + 0.3)


async def stand_still(drive: Drive, pid: int) -> None:
    """A process is stopped: the keys lock; it goes on: they unlock."""
    os.kill(pid, signal.SIGSTOP)
    began = time.monotonic()
    await until(drive.locked)
    assert time.monotonic() - began < OLDEST_PICTURE + LATE
    await until(lambda: drive.locked() and drive.feed.state().freshness is not Freshness.FRESH)
    assert drive.feed.value(ascii=False, command_age=0.1).grey
    with contextlib.suppress(ProcessLookupError):  # it was replaced
        os.kill(pid, signal.SIGCONT)
    await lasts(drive)


def test_what_stops_the_pictures_locks_the_keys() -> None:
    async def run() -> None:
        drive = Drive()
        try:
            drive.camera.start(WATCHER, time.monotonic())
            await lasts(drive)
            assert "±1 ms" in drive.feed.value(ascii=False, command_age=0.1).text
            await stand_still(drive, drive.link.pid)
            await stand_still(drive, drive.encoder)
            await stand_still(drive, drive.decoder)
            await stand_still(drive, drive.receiving)
            for name in ("encoder", "decoder", "receiving"):
                os.kill(getattr(drive, name), signal.SIGKILL)
                await until(drive.locked)
                await lasts(drive)
            drive.view = replace(drive.view, offset=-1.0)  # the pictures of a network that takes a second
            await until(drive.locked)
            assert drive.feed.value(ascii=False, command_age=None).text.startswith("OLD")
        finally:
            decoding = drive.feed._task
            drive.feed.stop()
            drive.link.close()
            drive.receiver.close()
            if decoding is not None:
                await asyncio.gather(decoding, return_exceptions=True)

    asyncio.run(run())


HUGE = "color=red:size=4096x2400:rate=2"
"""More pixels than MAX_PIXELS of ffmpeg_command.py, as 8K has; an encoder of this machine sends it."""


def test_huge_pictures_are_refused_and_others_fit() -> None:
    async def run() -> None:
        view, receiver = CameraView(1, free_port()), ReceiverLink(1)
        feed = CameraFeed(lambda: feed.choose_newest())

        def sees(fresh: bool) -> bool:
            feed.update(view, (80, 44))
            receiver.update(StreamOrders(view.port, (feed.request.port,)), time.monotonic())
            shown = feed.value(ascii=False, command_age=None).picture
            fits = shown is not None and (shown.width, shown.height) == (80, 44)
            return feed.state().fresh is fresh and (fits or not fresh)

        try:
            for picture, fresh in (
                ("testsrc2=size=320x180:rate=15", True),
                (HUGE, False),
                ("testsrc2=size=640x480:rate=15", True),
                ("testsrc2=size=96x300:rate=15", True),
            ):
                with camera("rtp", view.port, picture) as sender:
                    await until(lambda: sees(fresh))  # noqa: B023
                    assert sender.poll() is None
                await until(lambda: sees(False))
        finally:
            decoding = feed._task
            feed.stop()
            receiver.close()
            if decoding is not None:
                await asyncio.gather(decoding, return_exceptions=True)

    asyncio.run(run())


def test_without_a_stream_the_pane_says_why() -> None:
    feed = CameraFeed(lambda: None)
    assert feed.value(ascii=False, command_age=None).text.endswith("waiting for the station")
    feed.update(CameraView(1), (80, 44))
    assert "asking" in feed.value(ascii=False, command_age=None).text
    feed.update(CameraView(1, problem="the vehicle announces no camera"), (80, 44))
    assert "announces no camera" in feed.value(ascii=False, command_age=None).text
    assert feed.taken_at == 0.0
    assert feed.state().freshness is Freshness.NONE
