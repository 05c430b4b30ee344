"""Which other ground stations are heard."""

from __future__ import annotations

from dialects import messages as m
from dialects.enums import VehicleType
from groundstation.station.links.ground_stations import MAX_STATIONS, GroundStations
from groundstation.views.links import StationRow
from link.core import Peer, Received

PEER = Peer(0, "far")


def receive(stations: GroundStations, system: int, component: int, now: float, kind: int = VehicleType.GCS) -> None:
    beat = m.Heartbeat(kind, 8, 0, 0, 4, 3)
    stations.receive(Received(beat, system, component, 0, PEER, introduced=True), now)


def test_stations_by_id_with_the_time_since_their_heartbeat() -> None:
    stations = GroundStations()
    receive(stations, 250, 190, 1.0)
    receive(stations, 245, 191, 2.0)
    receive(stations, 250, 190, 3.0)
    receive(stations, 1, 1, 3.0, VehicleType.GROUND_ROVER)
    assert stations.build_rows(3.5) == (StationRow(245, 191, 1.5), StationRow(250, 190, 0.5))
    assert stations.build_rows(12.5) == (StationRow(250, 190, 9.5),)
    assert stations.build_rows(13.5) == ()


def test_a_free_id_is_nobodys() -> None:
    stations = GroundStations()
    assert stations.free_id(255, ()) == 254
    receive(stations, 254, 190, 1.0)
    assert stations.free_id(255, (1, 253)) == 252
    assert stations.free_id(252, (253,)) == 251


def test_a_flood_of_ids_does_not_grow_the_table_and_expires() -> None:
    stations = GroundStations()
    for system in range(1, 255):
        receive(stations, system, 190, 0.0)
    assert len(stations.build_rows(0.0)) == MAX_STATIONS
    receive(stations, 250, 190, 11.0)
    assert stations.build_rows(11.0) == (StationRow(250, 190, 0.0),)
