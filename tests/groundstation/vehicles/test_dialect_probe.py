"""The station asks whether a vehicle is one of ours, until it knows."""

from __future__ import annotations

import itertools

from dialects import messages as m
from dialects.enums import Autopilot, Command, Result
from groundstation.vehicles.dialect_probe import LONGEST_RETRY
from tests.groundstation.fake_ardupilot import FakeArduPilot
from tests.groundstation.fake_vehicle import Cockpit, FakeVehicle

REQUEST = Command.REQUEST_MESSAGE
STATUS = m.RoverDriveStatus(1, 0, 0, 0, [0, 0, 0, 0], 0, 0, 0)


class Kin(FakeVehicle):
    """Tells ROVER_DRIVE_STATUS from the first question on, as our rover does."""

    def __init__(self) -> None:
        super().__init__()
        self.telling = False

    def _obey(self, message: m.CommandLong, source: int) -> None:
        super()._obey(message, source)
        if message.command == REQUEST and message.param1 == m.RoverDriveInfo.id:
            self.telling = True
            self.say(m.RoverDriveInfo(2.0, 4.0, 0.4, 0.3, 450, 1, 0, 3, 0, 2))

    def tick(self, now: float) -> None:
        super().tick(now)
        if self.telling:
            self.say(STATUS)


def asked(vehicle: FakeVehicle) -> list[float]:
    """When, each repeat counted."""
    return [at for at, command in vehicle.all(m.CommandLong) if command.command == REQUEST]


def test_it_is_asked_at_first_contact_and_once() -> None:
    vehicle = Kin()
    cockpit = Cockpit(vehicle)
    cockpit.run(0.1)
    assert len(asked(vehicle)) == 1
    cockpit.run(30.0)
    assert [int(command.param1) for command in vehicle.commands(REQUEST)] == [m.RoverDriveInfo.id]
    assert "disarmed" not in cockpit.view.limits
    assert cockpit.view.limits == ()
    assert not any("46004" in text or "accepted" in text for text in cockpit.texts), "nobody needs to read of it"


def test_one_that_does_not_know_it_is_not_asked_again() -> None:
    vehicle = FakeVehicle(driver=None)
    vehicle.answers[REQUEST] = Result.UNSUPPORTED
    cockpit = Cockpit(vehicle)
    cockpit.run(60.0)
    assert len(asked(vehicle)) == 1


def test_one_that_has_not_heard_our_heartbeat_is_asked_again_soon() -> None:
    vehicle = Kin()
    vehicle.answers[REQUEST] = Result.TEMPORARILY_REJECTED
    cockpit = Cockpit(vehicle)
    cockpit.run(0.5)
    assert len(asked(vehicle)) == 2
    del vehicle.answers[REQUEST]
    cockpit.run(1.5)
    assert vehicle.telling


def test_a_mute_one_is_asked_ever_more_seldom() -> None:
    vehicle = FakeVehicle(driver=None)
    vehicle.silent_on.add(REQUEST)
    cockpit = Cockpit(vehicle)
    cockpit.run(600.0)
    times = asked(vehicle)
    assert 30 < len(times) < 130
    assert max(later - at for at, later in itertools.pairwise(times)) >= LONGEST_RETRY


def test_one_that_begins_anew_is_asked_again() -> None:
    vehicle = Kin()
    cockpit = Cockpit(vehicle)
    cockpit.run(3.0)
    vehicle.telling = False  # it restarted, or its link forgot us
    cockpit.run(3.0)
    assert vehicle.telling
    assert len(asked(vehicle)) == 2


def test_one_that_refused_is_asked_again_when_it_was_lost_and_is_back() -> None:
    vehicle = Kin()
    vehicle.answers[REQUEST] = Result.DENIED
    cockpit = Cockpit(vehicle)
    cockpit.run(3.0)
    cockpit.world.cut()
    cockpit.run(5.0)
    del vehicle.answers[REQUEST]
    cockpit.world.cut(False)
    cockpit.run(2.0)
    assert vehicle.telling


def test_ardupilot_and_px4_are_not_asked() -> None:
    for autopilot in (Autopilot.ARDUPILOT, Autopilot.PX4):
        vehicle = FakeArduPilot(autopilot=autopilot)
        Cockpit(vehicle).run(10.0)
        assert asked(vehicle) == []
