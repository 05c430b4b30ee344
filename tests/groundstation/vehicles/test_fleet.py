"""The vehicles found, the selected one, and their loss and return."""

from __future__ import annotations

from dialects import messages as m
from dialects.enums import Autopilot
from groundstation.vehicles.fleet import Fleet
from groundstation.vehicles.state.message_log import MessageLog
from groundstation.vehicles.state.vehicle_heartbeat import MAX_VEHICLES, is_vehicle
from link.core import Peer, Received
from tests.fakes.lone_verb import LoneVerb


def beat(system: int, autopilot: int = Autopilot.GENERIC, kind: int = 10) -> Received:
    message = m.Heartbeat(kind, autopilot, 0, 0, 3, 3)
    return Received(message, system, 1, 0, Peer(0, "vehicle"), introduced=True)


def fleet_of(*systems: int) -> tuple[Fleet, MessageLog]:
    log = MessageLog()
    fleet = Fleet(log, 255, 190)
    for system in systems:
        assert fleet.get_or_add(beat(system), 1.0) is not None
    return fleet, log


def texts(log: MessageLog) -> list[str]:
    return [line.text for line in log.build_lines(0.0, 0.0)]


def test_the_first_vehicle_is_selected() -> None:
    fleet, log = fleet_of(7, 3)
    assert fleet.selected is fleet.get(7)
    assert fleet.system_ids == (3, 7)
    assert texts(log) == ["Rover 7 found", "Rover 3 found"]


def test_the_first_vehicle_is_announced_once_it_can_be_shown() -> None:
    fleet, _ = fleet_of()
    shown: list[int] = []
    fleet.on_first = lambda: shown.append(0 if fleet.selected is None else fleet.selected.state.system)
    for system in (7, 3, 7):
        fleet.get_or_add(beat(system), 1.0)
    assert shown == [7]


def test_only_a_heartbeat_of_a_vehicle_adds_one() -> None:
    fleet, _ = fleet_of()
    assert not is_vehicle(beat(1, autopilot=Autopilot.INVALID).message)
    for received in (beat(1, autopilot=Autopilot.INVALID), beat(2, kind=6)):
        assert fleet.get_or_add(received, 1.0) is None
    assert fleet.system_ids == ()


def test_a_flood_of_system_ids_is_bounded() -> None:
    fleet, _ = fleet_of()
    for system in range(1, 200):
        fleet.get_or_add(beat(system), 1.0)
    assert len(fleet.system_ids) == MAX_VEHICLES


def test_vehicles_without_place_are_counted_and_the_first_logged() -> None:
    systems = range(1, MAX_VEHICLES + 1)
    fleet, log = fleet_of(*systems)
    assert fleet.not_shown == 0
    for now in (1.0, 2.0, 3.0):
        for system in (201, 202):
            assert fleet.get_or_add(beat(system), now) is None
        fleet.update(now)
    assert fleet.not_shown == 2
    assert texts(log)[-1] == f"more than {MAX_VEHICLES} vehicles: vehicle 201 and further ones are not shown"
    fleet.update(5.4)
    assert fleet.not_shown == 2
    fleet.update(5.6)
    assert fleet.not_shown == 0


def test_loss_and_return_are_logged_once_and_restart_requests() -> None:
    fleet, log = fleet_of(1)
    contact = fleet.get(1)
    assert contact is not None
    probe = contact.dialect_probe
    for now in (3.0, 4.0, 5.0):
        fleet.update(now)
    assert contact.lost_at == 1.0
    contact.state.receive(beat(1), 6.0)
    for now in (6.0, 6.5):
        fleet.update(now)
    assert contact.lost_at is None
    assert contact.dialect_probe is not probe
    assert texts(log) == ["Rover 1 found", "Rover 1: link lost for 2.5 s", "Rover 1: link back after 5.0 s"]


def test_only_ardupilots_settings_are_checked() -> None:
    fleet, _ = fleet_of(1)
    checked = fleet.get_or_add(beat(2, autopilot=Autopilot.ARDUPILOT), 1.0)
    unchecked = fleet.get(1)
    assert checked is not None
    assert unchecked is not None
    assert checked.settings_check is not None
    assert unchecked.settings_check is None


def signed_beat(system: int) -> Received:
    return beat(system)._replace(signed=True)


def test_a_vehicle_with_our_key_takes_the_place_of_one_without() -> None:
    fleet, _ = fleet_of(*range(1, MAX_VEHICLES + 1))
    own = fleet.get_or_add(signed_beat(200), 2.0)
    assert own is not None
    assert own.verified
    assert len(fleet.system_ids) == MAX_VEHICLES
    assert fleet.get(1) is fleet.selected, "the selected one stays"
    assert fleet.get_or_add(beat(201), 3.0) is None
    assert 200 in fleet.system_ids


def test_a_verb_has_a_place_for_the_vehicle_that_is_meant() -> None:
    verb = LoneVerb((254, 25), 200, 1)
    core = verb.core
    for system in range(1, MAX_VEHICLES + 1):
        verb.receive(beat(system), 1.0)
    verb.receive(beat(200), 2.0)
    assert core.chosen is not None
    assert core.chosen.state.system == 200
    assert len(core.contacts) == MAX_VEHICLES
    for system in range(1, MAX_VEHICLES + 1):
        verb.receive(beat(system), 3.0)
    verb.receive(beat(201)._replace(signed=True), 4.0)
    assert {200, 201} <= set(core.contacts), "the one that is meant keeps its place"
