"""The stream that a screen shows: received by a real process, passed on to it, and recorded beside the log."""

from __future__ import annotations

import socket
from contextlib import ExitStack
from pathlib import Path

import pytest

from dialects import messages as m
from groundstation.host.camera_receiver import CameraReceiver
from groundstation.intents.watch import Watch
from groundstation.recording.log_folder import MEGABYTE, LogFolder, LogLimits
from groundstation.recording.station_recording import StationRecording
from groundstation.stream.names import find_parts
from groundstation.stream.recorded_video import RecordedVideo
from groundstation.views.camera import CameraRequest
from link.core import Outgoing
from link.protocol.sent_frames import SentFrames
from link.services.video_stream import STAMPED
from tests.fakes.vehicle import FakeVehicle
from tests.groundstation.cockpits import cockpit_with
from tests.groundstation.stream.streams import annex_b, packets, unit_of
from tests.ports import free_port
from tests.waits import wait_until

pytestmark = pytest.mark.e2e
LIMITS = LogLimits(100 * MEGABYTE, 1000 * MEGABYTE)


def test_a_shown_stream_is_passed_on_and_recorded(tmp_path: Path) -> None:
    with ExitStack() as stack:
        cockpit, port = cockpit_with(FakeVehicle()), free_port()
        screen = stack.enter_context(socket.socket(socket.AF_INET, socket.SOCK_DGRAM))
        sender = stack.enter_context(socket.socket(socket.AF_INET, socket.SOCK_DGRAM))
        screen.bind(("127.0.0.1", free_port()))
        screen.setblocking(False)
        folder = LogFolder(tmp_path, LIMITS)
        recording = StationRecording(cockpit.station, folder, (255, 190), SentFrames())
        stack.callback(recording._session.close)
        receiver = CameraReceiver(cockpit.station, recording, 100)
        stack.callback(receiver.close)
        nals = [unit_of(number, key=number % 15 == 0, size=2000) for number in range(120)]
        sent = number = 0

        def step() -> None:
            """Let the station live for 0.1 s, and the camera send a picture."""
            nonlocal sent, number
            cockpit.station.views.build(CameraRequest(), cockpit.now, cockpit.now)
            cockpit.run(0.1)
            recording.tick(cockpit.now)
            receiver.tick(cockpit.now)
            for packet in packets(nals[sent % len(nals)], number, 6000 * sent):
                number += 1
                sender.sendto(packet, ("127.0.0.1", port))
            sent += 1

        def heard() -> bool:
            step()
            try:
                return bool(screen.recv(65536))
            except BlockingIOError:
                return False

        step()
        assert receiver._link.pid is None, "no screen shows the camera"
        cockpit.do(Watch(requests=(CameraRequest(screen.getsockname()[1]),)))
        stream = m.VideoStreamInformation(
            1, 1, 1, 0, 15, 320, 180, 600_000, 0, 70, STAMPED.encode(), str(port).encode(), 1, 1
        )
        step()
        cockpit.vehicle.outbox.append(Outgoing(stream))
        wait_until(heard, "a packet at the screen")
        assert folder.current is not None
        log = folder.current.path
        wait_until(lambda: find_parts(log), "a recording", each=step)
        said = f"recording pictures to {find_parts(log)[0]}"
        wait_until(lambda: said in [line.text for line in cockpit.snapshot.texts], "a line of it", each=step)
        receiver.close()
        video = RecordedVideo(log)
        video.refresh()
        units = [each.data for each in video.units()]
        assert units
        assert video.problem == ""
        assert set(units) <= {annex_b(each) for each in nals}
        assert video.is_stamped(0)
        video.close()
