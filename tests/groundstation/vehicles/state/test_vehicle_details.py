"""Details of one vehicle: places on earth, firmware, components. The bounds of its tables."""

from __future__ import annotations

import pytest

from dialects import messages as m
from groundstation.geo import Place
from groundstation.vehicles.state.vehicle_details import MAX_COMPONENTS, VehicleDetails, to_place
from link.core import Peer, Received

PEER = Peer(0, "far")


def receive(details: VehicleDetails, message: m.Message, component: int = 1, now: float = 0.0) -> None:
    details.receive(Received(message, 1, component, 0, PEER, introduced=True), now)


@pytest.mark.parametrize(("latitude", "longitude"), [(0, 0), (900_000_001, 0), (1, 1_800_000_001), (-(2**31), 5)])
def test_what_is_not_on_earth_is_no_place(latitude: int, longitude: int) -> None:
    assert to_place(latitude, longitude) is None


def test_a_lost_fix_keeps_the_last_place() -> None:
    details = VehicleDetails(1)
    receive(details, m.GlobalPositionInt(0, 100_000_000, 200_000_000, 0, 0, 0, 0, 0, 0))
    receive(details, m.GlobalPositionInt(0, 0, 0, 0, 0, 0, 0, 0, 0))
    assert details.place == Place(10.0, 20.0)


def test_another_component_is_listed_but_not_read_as_the_vehicle() -> None:
    details = VehicleDetails(1)
    receive(details, m.GlobalPositionInt(0, 100_000_000, 200_000_000, 0, 0, 0, 0, 0, 0), component=191)
    receive(details, m.RoverControl(1, 250, 190, 0), component=191)
    receive(details, m.Heartbeat(18, 8, 0, 0, 4, 3), component=191)
    receive(details, m.Heartbeat(250, 8, 0, 0, 4, 3), component=192)
    receive(details, m.Heartbeat(10, 0, 0, 0, 4, 3), component=1)
    assert (details.place, details.control_at) == (None, None)
    assert [(each.component, each.kind) for each in details.components(1.0)] == [
        (191, "onboard controller"), (192, "type 250"),
    ]  # fmt: skip
    assert details.components(11.0) == ()


def test_a_flood_of_components_does_not_grow_the_table() -> None:
    details = VehicleDetails(1)
    for component in range(2, 250):
        receive(details, m.Heartbeat(30, 8, 0, 0, 4, 3), component=component)
    assert len(details.components(0.0)) == MAX_COMPONENTS


@pytest.mark.parametrize(("number", "text"), [(0, ""), (0x04060100, "4.6.1"), (0x010F04FF, "1.15.4")])
def test_firmware(number: int, text: str) -> None:
    details = VehicleDetails(1)
    receive(details, m.AutopilotVersion(0, number, 0, 0, 0, [0] * 8, [0] * 8, [0] * 8, 0, 0, 0))
    assert details.firmware == text
