"""Two links to two different vehicles that have one id: named, not joined, and both stopped."""

from __future__ import annotations

from collections.abc import Hashable

from groundstation.intents.driving import EmergencyStop
from groundstation.intents.vehicle import Disarm
from link.core import Peer
from tests.links_world import End, LinksDrive, Path
from vehicle.control_loop import ControlLoop
from vehicle.drive.conversation import Conversation
from vehicle.motors.simulated import SimulatedMotors
from vehicle.params import Params
from vehicle.rover import Rover
from vehicle.safety.states import SafetyState
from vehicle.sim.battery import Battery
from vehicle.sim.body import SimulatedBody, SimulatedHome
from vehicle.sim.chassis import ChassisDimensions, SkidChassis


class TwoEnds(End):
    """A vehicle at the end of each link, both with the same ids."""

    def __init__(self, first: End, second: End) -> None:
        self.ends = (first, second)

    def receive(self, link: int, data: bytes, address: Hashable, now: float) -> None:
        self.ends[link].receive(link, data, address, now)

    def advance(self, now: float) -> None:
        for end in self.ends:
            end.advance(now)

    def pop_frames(self, now: float) -> list[tuple[int, bytes]]:
        return [each for link, end in enumerate(self.ends) for each in end.pop_frames(now) if each[0] == link]


def two_vehicles() -> tuple[LinksDrive, Rover]:
    """Return a station with the first vehicle, which is driven, and the second one, which was switched on later."""
    drive = LinksDrive(Path(0.01), Path(0.012))
    drive.paths[1].cut = True
    drive.get_going()
    motors, params = SimulatedMotors(), Params({})
    second = Rover(params, now=drive.now)
    body = SimulatedBody(
        lambda: motors.outputs,
        chassis=SkidChassis(ChassisDimensions(top_speed=params["SPEED_MAX"], track_width=params["TRACK_WIDTH"])),
        battery=Battery(1.0),
        home=SimulatedHome(),
        seed=None,
    )
    drive.far = TwoEnds(drive.far, End(ControlLoop(second, motors, body), (1, 1), 2, "near"))
    drive.paths[1].cut = False
    return drive, second


def test_a_second_vehicle_with_the_id_is_named_and_does_not_move() -> None:
    drive, second = two_vehicles()
    drive.run(8.0)  # the key is held all the while
    view = drive.station.snapshot(drive.now, 0).vehicle
    assert view is not None
    assert view.duplicates == "far (ARMED in MANUAL) and far (disarmed in MANUAL)"
    assert second.state is not SafetyState.ARMED
    assert drive.power == 0.0  # it stops: its echo is of the clock of the other one


def test_a_stop_goes_to_both_vehicles_of_an_id() -> None:
    for intent in (EmergencyStop(), Disarm()):
        drive, second = two_vehicles()
        drive.run(6.0)
        assert second._safety.arm(Conversation(255, 190, Peer(1, "near"), 0), drive.now) == []
        drive.run(1.0)
        assert second.state is SafetyState.ARMED
        drive.held = None
        drive.tell(intent)
        drive.run(1.0)
        assert drive.power == 0.0
        assert drive.rover.state is not SafetyState.ARMED
        assert second.state is not SafetyState.ARMED
