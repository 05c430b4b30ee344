"""The camera protocol: who asks, who watches, and when the camera may stop."""

from __future__ import annotations

import pytest

from dialects import messages as m
from dialects.enums import Command, Result
from link.core import Peer
from link.services.video_stream import STAMPED
from tests.vehicle.bench import OTHER, Bench
from vehicle.camera.camera import SILENCE, WATCHERS_MAX, Camera, CameraReport, find_host
from vehicle.camera.settings import SIMULATED_CAMERA
from vehicle.commands.camera import RUNNING

START, STOP = Command.VIDEO_START_STREAMING, Command.VIDEO_STOP_STREAMING
OLD = (
    (Command.REQUEST_CAMERA_INFORMATION, m.CameraInformation),
    (Command.REQUEST_VIDEO_STREAM_INFORMATION, m.VideoStreamInformation),
    (Command.REQUEST_VIDEO_STREAM_STATUS, m.VideoStreamStatus),
)


class Filming(Bench):
    """A rover with a camera."""

    def __init__(self) -> None:
        self.camera: Camera = Camera(SIMULATED_CAMERA)
        super().__init__()


def test_a_station_asks_what_and_where_the_camera_is() -> None:
    bench = Filming()
    bench.meet(OTHER)
    for old, message in OLD:
        count = len(bench.all(message))
        assert bench.command(Command.REQUEST_MESSAGE, message.id, system=OTHER) is Result.ACCEPTED
        assert bench.command(old, 1, system=OTHER) is Result.ACCEPTED
        assert len(bench.all(message)) == count + 2
        assert bench.command(old, 9, system=OTHER) is Result.DENIED
    stream = bench.newest(m.VideoStreamInformation)
    assert (stream.name, stream.uri, stream.type, stream.resolution_h) == (STAMPED, "5600", 1, 320)
    assert stream.bitrate == 2 * 600_000, "each packet is sent twice"
    assert not stream.flags & RUNNING
    bench.camera.note_report(CameraReport(10, 500_000), bench.now)
    bench.command(Command.REQUEST_MESSAGE, m.VideoStreamStatus.id, system=OTHER)
    status = bench.newest(m.VideoStreamStatus)
    assert (status.flags, status.framerate, status.bitrate) == (RUNNING, 10, 500_000)


def test_without_a_camera_nothing_is_known_of_one() -> None:
    bench = Bench()
    bench.meet(OTHER)
    for command, message in (*OLD, (START, m.VideoStreamStatus), (STOP, m.VideoStreamStatus)):
        assert bench.command(command, 1, system=OTHER) is Result.UNSUPPORTED
        assert bench.command(Command.REQUEST_MESSAGE, message.id, system=OTHER) is Result.UNSUPPORTED


def test_pictures_go_to_who_watches_until_he_stops() -> None:
    bench = Filming()
    bench.meet(OTHER)
    assert bench.camera.targets(bench.now) == ()
    assert bench.command(START, 2, system=OTHER) is bench.command(STOP, 2, system=OTHER) is Result.DENIED
    assert bench.command(START, 1, system=OTHER) is Result.FAILED, "its address on the bench is no IP address"
    assert bench.command(START, 1, system=OTHER) is Result.FAILED
    bench.heartbeat(OTHER)
    bench.wait(1.0)
    assert bench.texts.count("Camera refused: pictures need an IP link") == 1
    camera, watcher = bench.camera, Peer(0, ("10.0.0.2", 14550))
    assert camera.start(watcher, bench.now) is None
    assert camera.targets(bench.now) == (("10.0.0.2", 5600),)
    camera.stop(watcher)
    assert camera.targets(bench.now) == ()
    assert bench.command(STOP, 0, system=OTHER) is Result.ACCEPTED


def test_a_station_that_is_gone_gets_no_pictures() -> None:
    camera, watcher = Camera(SIMULATED_CAMERA), Peer(0, ("10.0.0.2", 14550))
    camera.start(watcher, 0.0)
    camera.hear(watcher, SILENCE)
    camera.hear(Peer(0, ("10.0.0.3", 14550)), SILENCE)
    assert camera.targets(2 * SILENCE) == (("10.0.0.2", 5600),)
    assert camera.targets(2 * SILENCE + 0.1) == ()
    for number in range(WATCHERS_MAX):
        assert camera.start(Peer(0, (f"10.0.0.{number}", 14550)), 20.0) is None
    assert camera.start(Peer(0, ("10.0.0.9", 14550)), 20.0)
    assert camera.start(Peer(0, ("10.0.0.1", 14550)), 20.0) is None


def test_only_links_with_an_ip_address_lead_to_a_picture() -> None:
    assert find_host(Peer(0, "udpout:10.0.0.2:14550")) == "10.0.0.2"
    assert find_host(Peer(0, ("::1", 14550, 0, 0))) == "::1"
    assert find_host(Peer(0, "serial:/dev/ttyUSB0:57600")) is find_host(Peer(0, "gcs 255")) is find_host(Peer(0, 3))


def test_who_asks_for_the_stream_gets_it_and_faults_are_told(monkeypatch: pytest.MonkeyPatch) -> None:
    bench = Filming()
    bench.meet(OTHER)
    started: list[Peer] = []
    monkeypatch.setattr(bench.camera, "start", lambda peer, now: started.append(peer))
    for command, parameter in ((Command.REQUEST_MESSAGE, m.VideoStreamInformation.id), (OLD[1][0], 1)):
        assert bench.command(command, parameter, system=OTHER) is Result.ACCEPTED
    assert bench.command(Command.REQUEST_MESSAGE, m.CameraInformation.id, system=OTHER) is Result.ACCEPTED
    assert len(started) == 2
    bench.camera.note_report(CameraReport(problem="rpicam-vid is not installed"), bench.now)
    bench.camera.note_report(CameraReport(problem="rpicam-vid is not installed"), bench.now)
    bench.meet(OTHER)
    bench.meet(OTHER)
    bench.heartbeat(OTHER)
    bench.wait(2.0)
    texts = [each for each in bench.texts if each.startswith("Camera")]
    assert texts == ["Camera: rpicam-vid is not installed"]
