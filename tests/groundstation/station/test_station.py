"""The station with a scripted vehicle: what it waits for, finds and shows."""

from __future__ import annotations

import pytest

from dialects import messages as m
from groundstation.intents.driving import HOLD_TIME
from groundstation.intents.session import LEASE_TIMEOUT, RenewLease
from groundstation.intents.vehicle import Arm, Disarm
from tests.groundstation.fake_vehicle import Cockpit


def test_waiting_line_names_the_endpoint() -> None:
    cockpit = Cockpit()
    cockpit.world.cut()
    cockpit.run(1.0)
    assert cockpit.snapshot.waiting == "waiting for a vehicle on udpin:127.0.0.1:14550"
    assert cockpit.snapshot.vehicle is None
    assert cockpit.operator.gate_reason == "no vehicle"


def test_bytes_without_a_vehicle_are_reported() -> None:
    cockpit = Cockpit()
    cockpit.vehicle.tick = lambda now: cockpit.vehicle.send(m.SystemTime(0, 0))  # type: ignore[method-assign]
    cockpit.run(2.0)
    waiting = cockpit.snapshot.waiting
    assert waiting is not None
    assert "no HEARTBEAT of a vehicle yet" in waiting


def test_a_ground_station_is_no_vehicle() -> None:
    cockpit = Cockpit()
    cockpit.vehicle.tick = lambda now: cockpit.vehicle.send(m.Heartbeat(6, 8, 0, 0, 4, 3))  # type: ignore[method-assign]
    cockpit.run(2.0)
    assert cockpit.station.fleet.system_ids == ()


def test_round_trip_and_loss_are_shown() -> None:
    cockpit = Cockpit()
    cockpit.world.up.delay = cockpit.world.down.delay = 0.03
    cockpit.run(6.0)
    (link,) = cockpit.snapshot.links
    assert link.round_trip == pytest.approx(0.06, abs=0.011)
    assert link.loss == 0.0
    assert link.rate > 0


def test_ticks_are_few_unless_a_command_is_under_way_and_it_is_idle_only_while_no_vehicle_is_armed() -> None:
    cockpit = Cockpit()
    cockpit.run(5.0)
    assert cockpit.station.may_rest
    assert cockpit.station.stands_idle
    cockpit.do(Arm(held=HOLD_TIME))
    assert not cockpit.station.may_rest, "commands are repeated"
    assert not cockpit.station.stands_idle
    cockpit.run(3.0)
    assert cockpit.vehicle.armed
    assert cockpit.station.may_rest
    assert not cockpit.station.stands_idle
    cockpit.do(Disarm())
    cockpit.run(3.0)
    assert not cockpit.vehicle.armed
    assert cockpit.station.may_rest
    assert cockpit.station.stands_idle


def test_a_crashed_station_does_not_rest() -> None:
    cockpit = Cockpit()
    cockpit.run(5.0)
    assert cockpit.core.may_rest
    cockpit.core.activate(cockpit.now)
    assert not cockpit.core.may_rest


def test_a_renewal_in_time_extends_the_lease_and_a_late_one_is_an_intent() -> None:
    cockpit = Cockpit()
    cockpit.leasing = False
    for _ in range(10):
        cockpit.run(0.25)
        assert cockpit.station.renew_lease(cockpit.now)
    assert cockpit.station.operator.live
    cockpit.run(LEASE_TIMEOUT + 0.05)
    assert not cockpit.station.renew_lease(cockpit.now)
    assert not cockpit.station.operator.live
    cockpit.do(RenewLease())
    assert cockpit.station.operator.live
