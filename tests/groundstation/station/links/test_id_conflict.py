"""Another ground station with our system id."""

from __future__ import annotations

from dialects.enums import Autopilot, VehicleType
from dialects.messages import Heartbeat
from groundstation.station.links.ground_stations import CONFLICT_TIMEOUT
from groundstation.station.station import Station
from link.core import Peer, Received

TEXT = "ground station 255/230 uses our system id: start with --system 254"


def beat(station: Station, now: float, *, system: int = 255, component: int = 230, kind: int = VehicleType.GCS) -> None:
    message = Heartbeat(kind, Autopilot.INVALID, 0, 0, 4, 3)
    station.receive(Received(message, system, component, 0, Peer(0, "bridge"), introduced=True), now)


def logged(station: Station, now: float) -> list[str]:
    return [line.text for line in station.snapshot(now, now).texts]


def test_a_station_with_our_system_id_is_named_while_it_is_there() -> None:
    station = Station(["memory"], now=100.0)
    assert station.snapshot(100.0, 0.0).id_conflict is None
    for second in range(10):
        beat(station, 100.0 + second)
    assert station.snapshot(110.0, 0.0).id_conflict == TEXT
    assert logged(station, 110.0) == [TEXT], "logged once"
    assert station.snapshot(109.1 + CONFLICT_TIMEOUT, 0.0).id_conflict is None
    beat(station, 120.0)
    assert sum(line.count for line in station.snapshot(120.0, 120.0).texts) == 2, "logged once for each appearance"
    assert station.snapshot(120.0, 0.0).id_conflict == TEXT


def test_other_stations_and_other_programs_are_no_conflict() -> None:
    station = Station(["memory"], now=100.0)
    beat(station, 100.0, system=254)
    beat(station, 100.0, kind=26)  # a gimbal
    assert station.snapshot(100.0, 0.0).id_conflict is None
    assert logged(station, 100.0) == []
