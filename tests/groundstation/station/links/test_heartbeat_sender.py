"""The station's own HEARTBEAT."""

from __future__ import annotations

from dialects import messages as m
from dialects.enums import SystemState
from groundstation.intents.session import RenewLease
from groundstation.station.links.heartbeat_sender import HeartbeatSender
from groundstation.station.station import Station
from groundstation.vehicles.state.vehicle_heartbeat import MAX_VEHICLES
from link.core import Peer, Received
from tests.groundstation.cockpits import Cockpit


def test_heartbeats_once_a_second_as_ground_station() -> None:
    cockpit = Cockpit()
    cockpit.run(2.0)
    greeted = cockpit.now
    cockpit.run(5.0)
    beats = [each for each in cockpit.vehicle.all(m.Heartbeat) if each[0] > greeted]
    assert len(beats) == 5
    beat = beats[0][1]
    assert (beat.type, beat.autopilot, beat.base_mode, beat.system_status) == (6, 8, 0, SystemState.ACTIVE)


def test_a_vehicle_at_a_new_address_gets_a_heartbeat_at_once() -> None:
    # It obeys only who has shown a heartbeat, and heard none of those that went out before it was there.
    station = Station(["udpin:127.0.0.1:14550"], now=100.0)
    station.handle_intent(RenewLease(), 100.0)
    station.tick(100.0)
    assert any(isinstance(each.message, m.Heartbeat) for each in station.messages_to_send())
    for address in ("one port", "another, after a restart"):
        beat = m.Heartbeat(10, 0, 1, 0, 3, 3)
        station.receive(Received(beat, 1, 1, 0, Peer(0, address), introduced=True), 100.1)
        station.tick(100.12)
        assert any(isinstance(each.message, m.Heartbeat) for each in station.messages_to_send())


def test_the_largest_fleet_gets_one_heartbeat_a_second_too() -> None:
    sender, sent = HeartbeatSender(0.0), 0
    for step in range(100):
        now = step / 10
        for number in range(MAX_VEHICLES):
            sender.greet(Peer(0, number), now)
        sent += len(sender.tick(now, driving=False)) if now >= 5.0 else 0
    assert sent == 5
