"""QGroundControl's camera sequence to the picture, after QGCCameraManager and VehicleCameraControl of its sources.

It takes the autopilot for a camera's proxy, asks it for CAMERA_INFORMATION and, of a camera with a stream, for
VIDEO_STREAM_INFORMATION. It listens at the port of that, and starts no stream: that is sent for a second one only.
"""

from __future__ import annotations

import asyncio
import socket
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest

from dialects import messages as m
from dialects.enums import Command, Result
from groundstation.video.decoder import find_program
from groundstation.video.feed import take_snapshot
from groundstation.video.ffmpeg_command import Shape
from groundstation.video.source import parse_source
from tests.groundstation.video.ffmpeg_sources import NEEDS_FFMPEG
from tests.interop.conftest import Rover
from tests.interop.qgroundcontrol import QGroundControl
from tests.waits import PATIENCE, wait_until
from vehicle.commands.camera import H264, HAS_VIDEO_STREAM, RUNNING

pytestmark = [pytest.mark.interop, NEEDS_FFMPEG]
LEGACY = ((Command.REQUEST_CAMERA_INFORMATION, m.CameraInformation),
          (Command.REQUEST_VIDEO_STREAM_INFORMATION, m.VideoStreamInformation),
          (Command.REQUEST_VIDEO_STREAM_STATUS, m.VideoStreamStatus))  # fmt: skip
SHAPE = Shape(80, 44, 10.0)
STORAGE, SETTINGS, CAPTURE = 261, 260, 262
"""STORAGE_INFORMATION, CAMERA_SETTINGS and CAMERA_CAPTURE_STATUS, which it asks of every camera."""


@pytest.fixture
def filming(tmp_path: Path) -> Iterator[Rover]:
    rover = Rover(tmp_path, "--camera")
    try:
        rover.speaks()
        yield rover
    finally:
        rover.vehicle.end()


def test_it_finds_the_camera_and_gets_its_picture(filming: Rover) -> None:
    with QGroundControl(filming.port) as ground:
        ground.meet()
        information = ground.request(m.CameraInformation)
        assert information.flags & HAS_VIDEO_STREAM
        assert (information.resolution_h, information.cam_definition_uri) == (320, "")
        for message in (STORAGE, SETTINGS, CAPTURE):
            assert ground.command(Command.REQUEST_MESSAGE, message) is Result.UNSUPPORTED
        stream = ground.request(m.VideoStreamInformation, 0.0)
        assert (stream.count, stream.stream_id, stream.encoding) == (1, 1, H264)
        assert stream.uri.isdigit(), "it listens at udp://0.0.0.0:URI"
        pictures = _receive(ground, int(stream.uri))
        assert pictures[12] & 0x1F in (1, 5, 6, 7, 8, 24, 28), "H.264 in RTP"
        wait_until(lambda: ground.request(m.VideoStreamStatus, 1.0).flags & RUNNING, "the stream runs")
        for command, _ in LEGACY:
            assert ground.command(command, 1) is Result.ACCEPTED

        source = parse_source(f"rtp:127.0.0.1:{stream.uri}", Path())
        with ThreadPoolExecutor() as pool:
            seen = pool.submit(lambda: asyncio.run(take_snapshot(source, find_program(), SHAPE, PATIENCE)))
            wait_until(seen.done, "a picture", each=lambda: ground.listen(0.05))
        assert len(set(seen.result().rgb)) > 8
        assert ground.command(Command.VIDEO_STOP_STREAMING, 1) is Result.ACCEPTED
        wait_until(lambda: not ground.request(m.VideoStreamStatus, 1.0).flags & RUNNING, "the stream ends")


def _receive(ground: QGroundControl, port: int) -> bytes:
    """Return the first packet that comes to a port, while it is heard."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as ear:
        ear.bind(("127.0.0.1", port))
        ear.setblocking(False)

        def read() -> bytes:
            try:
                return ear.recv(65536)
            except BlockingIOError:
                return b""

        return wait_until(read, "a packet", each=lambda: ground.listen(0.05))
