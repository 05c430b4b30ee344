"""The station with a scripted vehicle: what it waits for, finds and shows."""

from __future__ import annotations

import pytest

from dialects import messages as m
from dialects.codec import encode_payload
from groundstation.intents.session import LEASE_TIMEOUT, REST_PERIOD, RenewLease
from groundstation.intents.vehicle import Arm, Disarm
from groundstation.intents.vehicle_intent import HOLD_TIME
from groundstation.snapshot import Snapshot
from groundstation.station.driving.driven import DEMAND_MEMORY
from groundstation.station.operator_core import REST_AFTER, TICK_PERIOD
from tests.fakes.rover import FakeArduPilot
from tests.groundstation.cockpits import Cockpit, armed_cockpit


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


def test_a_snapshot_changes_nothing() -> None:
    seen: list[Snapshot] = []
    sent: list[list[tuple[float, bytes]]] = []
    for looked in (False, True):
        cockpit = Cockpit(FakeArduPilot())
        cockpit.run(2.0)
        cockpit.vehicle.send(m.StatusText(4, b"PreArm: Compass not calibrated"))
        for _ in range(30):
            cockpit.run(0.1)
            for _ in range(3 if looked else 0):
                assert cockpit.snapshot == cockpit.snapshot
        seen.append(cockpit.snapshot)
        sent.append([(at, encode_payload(message)) for at, message in cockpit.world.near.sent])
    assert seen[0] == seen[1]
    assert sent[0] == sent[1]
    assert seen[0].faults, "the doctor has found what is wrong without it"


def test_round_trip_and_loss_are_shown() -> None:
    cockpit = Cockpit()
    cockpit.world.up.delay = cockpit.world.down.delay = 0.03
    cockpit.run(6.0)
    (link,) = cockpit.snapshot.links
    assert link.round_trip == pytest.approx(0.06, abs=0.011)
    assert link.loss == 0.0
    assert link.rate > 0


def resting_cockpit() -> Cockpit:
    cockpit = Cockpit()
    for _ in range(100):
        cockpit.run(0.1)
        if cockpit.station.rests:
            return cockpit
    raise AssertionError("it does not rest")


def test_ticks_are_few_without_commands_and_while_disarmed() -> None:
    cockpit = resting_cockpit()
    assert cockpit.station.rest_period == REST_PERIOD
    assert cockpit.snapshot.rests
    ended = []
    cockpit.station.on_rest_end = lambda: ended.append(cockpit.now)
    cockpit.do(Arm(held=HOLD_TIME))
    assert ended == [cockpit.now], "at once"
    assert cockpit.station.rest_period is None, "commands are repeated"
    assert not cockpit.snapshot.rests
    cockpit.run(3.0)
    assert cockpit.vehicle.armed
    assert cockpit.station.rest_period == TICK_PERIOD
    cockpit.do(Disarm())
    cockpit.run(2.0)
    assert not cockpit.vehicle.armed
    assert cockpit.station.rest_period == TICK_PERIOD, "a vehicle that was driven just now may hold a demand"
    cockpit.run(DEMAND_MEMORY + REST_AFTER)
    assert cockpit.station.rest_period == REST_PERIOD


def test_vehicle_armed_by_another_ends_the_rest_with_its_report() -> None:
    cockpit = resting_cockpit()
    assert cockpit.station.rests
    ended = []
    cockpit.station.on_rest_end = lambda: ended.append(cockpit.now)
    cockpit.vehicle.armed = True
    cockpit.vehicle.beat()
    cockpit.run(0.01)
    assert len(ended) == 1
    assert not cockpit.station.rests


def test_a_crashed_station_does_not_rest() -> None:
    cockpit = resting_cockpit()
    assert cockpit.core.rest_period == REST_PERIOD
    cockpit.core.activate(cockpit.now)
    assert cockpit.core.rest_period is None


def test_renewal_in_time_extends_lease_and_a_late_is_an_intent() -> None:
    cockpit = armed_cockpit()
    cockpit.leasing = False
    cockpit.do(RenewLease())
    for _ in range(10):
        cockpit.run(LEASE_TIMEOUT - 0.05)
        assert cockpit.station.renew_lease(cockpit.now)
    assert cockpit.station.operator.live
    cockpit.run(LEASE_TIMEOUT + 0.05)
    assert not cockpit.station.renew_lease(cockpit.now)
    assert not cockpit.station.operator.live
    cockpit.do(RenewLease())
    assert cockpit.station.operator.live
