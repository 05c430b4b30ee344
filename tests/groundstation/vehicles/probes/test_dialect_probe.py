"""The station requests ROVER_DRIVE_INFO until it knows whether the vehicle speaks our dialect."""

from __future__ import annotations

import itertools

from dialects import messages as m
from dialects.enums import Autopilot, Command, Result
from groundstation.vehicles.probes.dialect_probe import LONGEST_RETRY
from groundstation.verbs.session.contact import VehicleContact
from groundstation.verbs.session.core import VerbCore
from groundstation.verbs.session.operator import PROOFS_FIRST
from groundstation.verbs.session.station_seat import StationSeat
from tests.fakes.rover import FakeArduPilot
from tests.fakes.vehicle import FakeVehicle
from tests.groundstation.cockpits import Cockpit

REQUEST = Command.REQUEST_MESSAGE
STATUS = m.RoverDriveStatus(1, 0, 0, 0, [0, 0, 0, 0], 0, 0, 0)


class Kin(FakeVehicle):
    """Sends ROVER_DRIVE_STATUS from the first request on, as our rover does."""

    def __init__(self) -> None:
        super().__init__()
        self.telling = False

    def _obey(self, message: m.CommandLong | m.CommandInt, source: int) -> bool:
        if message.command == REQUEST and message.param1 == m.RoverDriveInfo.id:
            self.telling = True
            self.send(m.RoverDriveInfo(2.0, 4.0, 0.4, 0.3, 450, 1, 0, 3, 0, 2))
        return super()._obey(message, source)

    def tick(self, now: float) -> None:
        super().tick(now)
        if self.telling:
            self.send(STATUS)


def asked(vehicle: FakeVehicle) -> list[float]:
    """When, each repeat counted."""
    return [
        at
        for at, command in vehicle.all(m.CommandLong)
        if command.command == REQUEST and command.param1 == m.RoverDriveInfo.id
    ]


def test_requested_once_at_first_contact() -> None:
    vehicle = Kin()
    cockpit = Cockpit(vehicle)
    cockpit.run(0.1)
    assert len(asked(vehicle)) == 1
    cockpit.run(30.0)
    assert [int(command.param1) for command in vehicle.commands(REQUEST)] == [m.RoverDriveInfo.id]
    assert "disarmed" not in cockpit.view.limits
    assert cockpit.view.limits == ()
    assert not any("46004" in text or "accepted" in text for text in cockpit.texts), "nobody needs to read of it"


def test_not_requested_again_after_a_refusal() -> None:
    vehicle = FakeVehicle(driver=None)
    vehicle.answers[REQUEST] = Result.UNSUPPORTED
    cockpit = Cockpit(vehicle)
    cockpit.run(60.0)
    assert len(asked(vehicle)) == 1


def test_requested_again_soon_if_our_heartbeat_was_not_received() -> None:
    vehicle = Kin()
    vehicle.answers[REQUEST] = Result.TEMPORARILY_REJECTED
    cockpit = Cockpit(vehicle)
    cockpit.run(0.5)
    assert len(asked(vehicle)) == 2
    del vehicle.answers[REQUEST]
    cockpit.run(1.5)
    assert vehicle.telling


def test_requested_ever_less_often_without_an_answer() -> None:
    vehicle = FakeVehicle(driver=None)
    vehicle.silent_on.add(REQUEST)
    cockpit = Cockpit(vehicle)
    cockpit.run(600.0)
    times = asked(vehicle)
    assert 30 < len(times) < 130
    assert max(later - at for at, later in itertools.pairwise(times)) >= LONGEST_RETRY


def test_requested_again_after_a_restart() -> None:
    vehicle = Kin()
    cockpit = Cockpit(vehicle)
    cockpit.run(3.0)
    vehicle.telling = False  # it restarted, or its link forgot us
    cockpit.run(3.0)
    assert vehicle.telling
    assert len(asked(vehicle)) == 2


def test_requested_again_after_a_refusal_when_lost_and_back() -> None:
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


def test_not_requested_from_ardupilot_and_px4() -> None:
    for autopilot in (Autopilot.ARDUPILOT, Autopilot.PX4):
        vehicle = FakeArduPilot(autopilot=autopilot)
        Cockpit(vehicle).run(10.0)
        assert asked(vehicle) == []


def begin_verb(cockpit: Cockpit) -> VehicleContact:
    """Begin a verb that takes part; return its vehicle."""
    core = VerbCore(cockpit.station, 1)
    StationSeat(cockpit.station, core, "a verb", lambda: None, needs_session=True).join(cockpit.now)
    contact = core.contacts[1]
    contact.begin(cockpit.now)
    return contact


def test_a_verb_has_the_vehicle_asked_where_no_screen_is() -> None:
    vehicle = Kin()
    vehicle.silent_on.add(REQUEST)
    cockpit = Cockpit(vehicle)
    cockpit.leasing = False
    cockpit.run(4.0)
    before = len(asked(vehicle))
    vehicle.silent_on.clear()
    cockpit.run(4.0)
    assert len(asked(vehicle)) == before
    contact = begin_verb(cockpit)
    cockpit.run(1.0)
    assert len(asked(vehicle)) == before + 1
    assert len(vehicle.all(m.RoverOperatorPresence)) >= PROOFS_FIRST
    assert contact.settled


def test_a_verb_waits_for_no_pause_and_for_one_answer() -> None:
    vehicle = FakeVehicle(driver=None)
    vehicle.silent_on.add(REQUEST)
    cockpit = Cockpit(vehicle)
    cockpit.run(60.0)
    before = len(asked(vehicle))
    contact = begin_verb(cockpit)
    cockpit.run(0.2)
    assert len(asked(vehicle)) == before + 1
    assert not contact.settled
    cockpit.run(3.0)
    assert contact.settled
    assert vehicle.all(m.RoverOperatorPresence) == []
