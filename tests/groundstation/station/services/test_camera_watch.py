"""The camera of the selected vehicle: found, started while a screen shows it, and stopped after."""

from __future__ import annotations

from dialects import messages as m
from dialects.enums import Command
from groundstation.intents.watch import Watch
from groundstation.station.services.camera_watch import ASK_TRIES, WANTED_FOR
from groundstation.views.base import View
from groundstation.views.camera import CameraRequest, CameraView
from link.core import Outgoing
from link.services.video_stream import STAMPED
from tests.fakes.vehicle import FakeVehicle
from tests.groundstation.cockpits import Cockpit, cockpit_with

INFORMATION = m.VideoStreamInformation(1, 1, 1, 0, 15, 320, 180, 600_000, 0, 70, STAMPED.encode(), b"5600", 1, 1)


def asked(cockpit: Cockpit, command: Command) -> int:
    """How often the vehicle got a command."""
    found = [message for _, message in cockpit.vehicle.all(m.CommandLong) if message.command == command]
    wanted = m.VideoStreamInformation.id
    return sum(command is not Command.REQUEST_MESSAGE or message.param1 == wanted for message in found)


def shown(cockpit: Cockpit, seconds: float) -> CameraView:
    """Show the pane for so long."""
    found: View | None = None
    for _ in range(round(seconds / 0.1)):
        cockpit.run(0.1)
        found = cockpit.station.views.build(CameraRequest(), cockpit.now, cockpit.now)
    assert isinstance(found, CameraView)
    return found


def test_a_stream_is_found_started_and_stopped() -> None:
    cockpit = cockpit_with(FakeVehicle())
    cockpit.run(2.0)
    assert asked(cockpit, Command.REQUEST_MESSAGE) == asked(cockpit, Command.VIDEO_START_STREAMING) == 0
    cockpit.do(Watch(requests=(CameraRequest(),)))
    assert shown(cockpit, 1.0).port == 0
    assert asked(cockpit, Command.REQUEST_MESSAGE) >= 1
    cockpit.vehicle.outbox.append(Outgoing(INFORMATION))
    view = shown(cockpit, 3.0)
    assert (view.port, view.stamped) == (5600, True)
    assert view.offset is not None
    assert asked(cockpit, Command.VIDEO_START_STREAMING) >= 1
    assert asked(cockpit, Command.VIDEO_STOP_STREAMING) == 0
    cockpit.do(Watch(requests=()))
    cockpit.run(WANTED_FOR + 1.0)
    assert asked(cockpit, Command.VIDEO_STOP_STREAMING) >= 1


def test_a_vehicle_without_a_camera_is_said_to_have_none() -> None:
    cockpit = cockpit_with(FakeVehicle())
    view = shown(cockpit, 20.0)
    assert view.problem == "the vehicle announces no camera"
    assert asked(cockpit, Command.REQUEST_MESSAGE) >= ASK_TRIES


def test_a_stream_of_another_kind_is_not_shown() -> None:
    cockpit = cockpit_with(FakeVehicle())
    shown(cockpit, 1.0)
    rtsp = m.VideoStreamInformation(1, 1, 0, 0, 15, 320, 180, 0, 0, 0, b"front", b"rtsp://10.0.0.2/x", 1, 0)
    cockpit.vehicle.outbox.append(Outgoing(rtsp))
    view = shown(cockpit, 1.0)
    assert view.port == 0
    assert "mavhelm video" in view.problem
