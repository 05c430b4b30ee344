"""Which component of a system is the vehicle, whoever is heard first."""

from __future__ import annotations

import pytest

from dialects import messages as m
from dialects.enums import Autopilot
from dialects.kinds import NO_VEHICLES
from groundstation.connect.heard import HeardVehicles
from groundstation.vehicles.demand.repeated_stop import StopTimes
from groundstation.vehicles.fleet import Fleet
from groundstation.vehicles.requests.requests import RequestReport
from groundstation.vehicles.state.message_log import MessageLog
from groundstation.vehicles.state.vehicle_heartbeat import is_vehicle, replaces
from groundstation.verbs.control.stop_jobs import disarm_job
from groundstation.verbs.session.core import ALONE_AFTER
from link.core import Peer, Received
from tests.fakes.lone_verb import LoneVerb

PEER = Peer(0, "vehicle")
GIMBAL, CAMERA, ADSB, COMPANION, ROVER, ANTENNA_TRACKER = 26, 30, 27, 18, 10, 5
ARMED_IN_AUTO = m.Heartbeat(ROVER, Autopilot.ARDUPILOT, 81 | 128, 10, 4, 3)


def beat(kind: int, autopilot: int = 0, component: int = 191) -> Received:
    message = m.Heartbeat(kind, autopilot, 0, 0, 4, 3)
    return Received(message, 1, component, 0, PEER, introduced=True)


def autopilot(component: int = 1) -> Received:
    return Received(ARMED_IN_AUTO, 1, component, 0, PEER, introduced=True)


@pytest.mark.parametrize("kind", [GIMBAL, CAMERA, ADSB, COMPANION, 31, 34, 36, 37, 42, 49])
def test_part_of_a_vehicle_is_none_even_if_it_names_an_autopilot(kind: int) -> None:
    assert kind in NO_VEHICLES
    for name in (Autopilot.GENERIC, Autopilot.ARDUPILOT, Autopilot.PX4):
        assert not is_vehicle(beat(kind, name).message)


@pytest.mark.parametrize("kind", [0, 1, 2, ANTENNA_TRACKER, ROVER, 11, 12])
def test_what_has_motors_is_a_vehicle(kind: int) -> None:
    assert is_vehicle(beat(kind).message)


def test_only_the_autopilot_replaces_another_component() -> None:
    assert [replaces(*each) for each in ((1, 191), (1, 1), (191, 1), (2, 191))] == [True, False, False, False]


def test_autopilot_replaces_a_script_that_claims_to_be_a_rover() -> None:
    log = MessageLog()
    fleet = Fleet(log, 255, 190)
    contact = fleet.get_or_add(beat(ROVER), 1.0)
    assert contact is not None
    assert (contact.state.component, contact.state.armed) == (191, False)
    assert fleet.get_or_add(autopilot(), 1.5) is contact
    contact.state.receive(autopilot(), 1.5)
    for now in (2.0, 3.0):
        fleet.get_or_add(beat(ROVER), now)
        contact.state.receive(beat(ROVER), now)
    state = contact.state
    assert (state.component, state.mode, state.armed, fleet.selected) == (1, "AUTO", True, contact)
    assert contact.settings_check is not None
    assert "vehicle 1: component 1 is its autopilot, not 191" in [line.text for line in log.build_lines(0.0, 0.0)]


def test_a_request_to_the_former_component_is_refused() -> None:
    verb = LoneVerb((254, 25), None, 1)
    core = verb.core
    verb.receive(beat(ROVER), 1.0)
    verb.tick(1.01 + ALONE_AFTER)
    contact = core.chosen
    assert contact is not None
    reports: list[RequestReport] = []
    core.station.services.follow(1, reports.append)
    contact.services.commands.send(1, 520, (1.0,), "ask", 2.5)
    verb.receive(autopilot(), 2.6)
    [report] = [each for each in reports if each.state.ended]
    assert report.detail == "component 1 is the autopilot, not 191: request it again"
    contact.services.commands.send(2, 520, (1.0,), "ask", 2.7)
    assert [each.message.target_component for each in verb.messages_to_send() if type(each.message) is m.CommandLong][
        -1
    ] == 1


def test_a_stop_goes_on_when_the_autopilot_is_heard() -> None:
    verb = LoneVerb((254, 25), None, 1)
    core = verb.core
    verb.receive(beat(ROVER), 1.0)
    verb.tick(1.01 + ALONE_AFTER)
    contact = core.chosen
    assert contact is not None
    contact.services.book.begin(1, "disarm")
    contact.start(disarm_job(1, contact.state, StopTimes(2.5, 2.5, 30.0)), 2.5)
    verb.messages_to_send()
    verb.receive(autopilot(), 2.6)
    verb.tick(4.0)
    sent = [each.message for each in verb.messages_to_send()]
    assert {each.target_component for each in sent if type(each) is m.CommandLong} == {1}
    assert [report.number for report in contact.services.book.running] == [1]


def test_a_verb_waits_for_the_autopilot_behind_a_script() -> None:
    verb = LoneVerb((254, 25), None, 1)
    core = verb.core
    verb.receive(beat(ROVER), 1.0)
    verb.tick(1.0 + ALONE_AFTER - 0.1)
    assert core.chosen is None
    verb.receive(autopilot(), 1.0 + ALONE_AFTER - 0.05)
    assert core.chosen is not None
    assert core.chosen.state.armed


def test_a_verb_takes_the_second_autopilot_if_there_is_no_first() -> None:
    verb = LoneVerb((254, 25), None, 1)
    core = verb.core
    verb.receive(autopilot(2), 1.0)
    assert core.chosen is None
    verb.tick(1.01 + ALONE_AFTER)
    assert core.chosen is not None
    assert core.chosen.state.component == 2


def test_what_came_before_a_heartbeat_counts_as_not_heard() -> None:
    """Its contact has not taken it: `status` would not request it, and print that nobody is in control."""
    verb, system = LoneVerb((254, 25), None, 1), 1
    core = verb.core
    control = Received(m.ControlStatus(0, 254, [0] * 10), system, 1, 0, PEER, introduced=True)
    verb.receive(control, 1.0)
    verb.receive(autopilot(), 1.1)
    assert (system, m.ControlStatus) not in core.heard
    verb.receive(control, 1.2)
    assert core.heard[system, m.ControlStatus] == 1.2
    assert core.contacts[system].state.driver == 254


def test_the_list_of_what_is_heard_shows_the_autopilot() -> None:
    heard = HeardVehicles()
    heard.receive("udpin:x", [beat(CAMERA, 0), beat(ROVER), autopilot(), beat(ROVER)], 40, 1.0)
    [row] = heard.rows(1.0)
    assert (row.mode, row.armed) == ("AUTO", True)
