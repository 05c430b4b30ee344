"""What a vehicle says about itself: asked a few times, in any order of the answers."""

from __future__ import annotations

from dialects import messages as m
from groundstation.vehicles.state.identity import RETRY_AFTER, TRIES, VERSION, RequestedMessage, VehicleIdentity
from tests.link.services_world import from_vehicle

ALL_MODES = RequestedMessage(m.AvailableModes.id)


def mode(index: int, count: int = 3) -> m.AvailableModes:
    return m.AvailableModes(count, index, 0, index * 10, 2 if index == 3 else 0, f"MODE{index}".encode())


def version(capabilities: int = 32) -> m.AutopilotVersion:
    return m.AutopilotVersion(capabilities, 0, 0, 0, 0, [0] * 8, [0] * 8, [0] * 8, 0, 0, 0)


def requests(identity: VehicleIdentity, until: float) -> list[RequestedMessage]:
    """Return what is requested in 0.1 s steps while nothing answers."""
    asked = (identity.next_request(step / 10) for step in range(round(until * 10)))
    return [request for request in asked if request is not None]


def test_vehicle_without_a_version_is_settled_after_three_tries() -> None:
    identity = VehicleIdentity(1)
    assert requests(identity, TRIES * RETRY_AFTER) == [VERSION] * TRIES
    assert not identity.settled
    assert requests(identity, 10) == []
    assert identity.settled
    assert identity.may_have_files, "not known"


def test_a_refusal_settles_it_at_once() -> None:
    identity = VehicleIdentity(1)
    assert identity.next_request(0.0) == VERSION
    identity.handle_refusal()
    assert identity.next_request(0.0) is None
    assert identity.settled


def test_capabilities() -> None:
    identity = VehicleIdentity(1)
    identity.receive(from_vehicle(version(0)))
    assert (identity.settled, identity.capabilities, identity.may_have_files) == (True, 0, False)
    identity.receive(from_vehicle(version(32), component=154))
    assert identity.capabilities == 0, "of the camera"


def test_modes_come_together_and_a_lost_one_is_requested_alone() -> None:
    identity = VehicleIdentity(1)
    identity.receive(from_vehicle(version()))
    identity.want_modes()
    assert identity.next_request(0.0) == ALL_MODES
    for index in (3, 1):
        identity.receive(from_vehicle(mode(index)))
    assert identity.modes is None
    assert identity.next_request(RETRY_AFTER) == RequestedMessage(m.AvailableModes.id, 2)
    identity.receive(from_vehicle(mode(2)))
    assert identity.modes is not None
    assert [(each.name, each.custom_mode, each.selectable) for each in identity.modes] == [
        ("MODE1", 10, True),
        ("MODE2", 20, True),
        ("MODE3", 30, False),
    ]
    assert identity.next_request(10.0) is None


def test_a_vehicle_that_sends_one_mode_at_a_time_is_asked_on() -> None:
    identity = VehicleIdentity(1)
    identity.receive(from_vehicle(version()))
    identity.want_modes()
    identity.next_request(0.0)
    identity.receive(from_vehicle(mode(1)))
    now = RETRY_AFTER
    for index in (2, 3):
        assert identity.next_request(now) == RequestedMessage(m.AvailableModes.id, index)
        identity.receive(from_vehicle(mode(index)))
    assert identity.modes is not None


def test_a_changed_set_of_modes_is_requested_again() -> None:
    identity = VehicleIdentity(1)
    identity.receive(from_vehicle(version()))
    identity.want_modes()
    identity.next_request(0.0)
    for index in (1, 2, 3):
        identity.receive(from_vehicle(mode(index)))
    identity.receive(from_vehicle(m.AvailableModesMonitor(4)))
    assert identity.modes is not None
    identity.receive(from_vehicle(m.AvailableModesMonitor(5)))
    assert identity.modes is None
    assert identity.next_request(RETRY_AFTER) == ALL_MODES


def test_modes_that_never_come_are_settled() -> None:
    identity = VehicleIdentity(1)
    identity.receive(from_vehicle(version()))
    identity.want_modes()
    assert requests(identity, 10) == [ALL_MODES] * TRIES
    assert identity.modes_settled
    assert identity.modes is None


def test_impossible_indexes_are_ignored() -> None:
    identity = VehicleIdentity(1)
    for index, count in ((0, 3), (4, 3), (1, 255)):
        identity.receive(from_vehicle(mode(index, count)))
    assert identity.modes is None
