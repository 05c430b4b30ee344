"""The operator's session: lease, key gate, and the presence message before each demand."""

from __future__ import annotations

import pytest

from dialects import messages as m
from dialects.enums import Autopilot
from groundstation.intents.driving import DriveKeyDown, DriveKeyUp
from groundstation.intents.session import RenewLease, ReportKeyReleases, SetKeyGate
from tests.fakes.vehicle import FakeVehicle
from tests.groundstation.cockpits import FORWARD, armed_cockpit, driving_cockpit


def test_closing_the_gate_is_neutral_at_once() -> None:
    cockpit = driving_cockpit()
    closed = cockpit.now
    cockpit.do(SetKeyGate(open=False, reason="help is open"))
    cockpit.run(0.3)
    demands = cockpit.demands(closed + 0.001)
    assert demands
    assert demands[0][0] - closed <= 0.006
    assert all(x == 0 for _, x, _ in demands)
    assert cockpit.operator.gate_reason == "help is open"
    assert cockpit.operator.held == ()
    cockpit.do(FORWARD, SetKeyGate(open=True), DriveKeyDown(key="i", throttle=1, steering=0, repeat=True))
    cockpit.run(0.3)
    assert cockpit.demands()[-1][1] == 0, "a key pressed behind a closed gate must not drive after it opened"


def test_key_repeating_from_before_gate_opened_does_not_drive() -> None:
    cockpit = armed_cockpit()
    cockpit.do(SetKeyGate(open=False, reason="help is open"), FORWARD)
    cockpit.run(0.3)
    cockpit.do(SetKeyGate(open=True))
    cockpit.run(0.3)
    start = cockpit.now
    for _ in range(40):  # no releases here: the repeats of the old press, from 0.6 s after it on
        cockpit.do(FORWARD)
        cockpit.run(0.04)
    assert all(x == 0 for _, x, _ in cockpit.demands(start))
    assert cockpit.operator.held_over
    cockpit.run(0.76)
    assert not cockpit.operator.held_over
    cockpit.do(FORWARD)
    cockpit.run(0.2)
    assert cockpit.demands()[-1][1] == 600


def test_a_frozen_screen_is_neutral_in_half_a_second_then_silent() -> None:
    cockpit = driving_cockpit()
    frozen = cockpit.now
    cockpit.leasing = False
    cockpit.run(5.0)
    moving = [at for at, x, _ in cockpit.demands(frozen) if x]
    assert max(moving) - frozen <= 0.45
    neutral = [at for at, x, _ in cockpit.demands(max(moving) + 0.001) if x == 0]
    assert len(set(neutral)) == 5
    assert max(at for at, _ in cockpit.vehicle.all(m.Heartbeat)) - frozen <= 1.1
    assert not cockpit.operator.sending
    assert cockpit.operator.held == ()


def test_keys_typed_at_a_frozen_screen_do_not_drive_at_its_thaw() -> None:
    cockpit = driving_cockpit()
    cockpit.leasing = False
    cockpit.run(2.0)
    thawed = cockpit.now
    cockpit.do(RenewLease(), FORWARD, DriveKeyDown(key="i", throttle=1, steering=0, repeat=True))
    cockpit.leasing = True
    cockpit.run(1.0)
    assert all(x == 0 for _, x, _ in cockpit.demands(thawed))
    cockpit.do(DriveKeyUp(key="i"), FORWARD)
    cockpit.run(0.1)
    assert cockpit.demands()[-1][1] == 600


def test_operator_presence_precedes_each_demand_of_our_dialect() -> None:
    cockpit = armed_cockpit()
    cockpit.run(0.5)
    cockpit.do(ReportKeyReleases(), FORWARD)
    cockpit.run(0.3)
    tail = [
        message
        for _, message in cockpit.vehicle.received
        if isinstance(message, (m.RoverOperatorPresence, m.ManualControl))
    ]
    assert [type(message) for message in tail[-4:]] == [m.RoverOperatorPresence, m.ManualControl] * 2
    proof = tail[-2]
    assert isinstance(proof, m.RoverOperatorPresence)
    assert (proof.target_system, proof.target_component, proof.session_id, proof.flags) == (1, 1, 7, 3 | 16)
    assert (proof.x, proof.y, proof.z, proof.r) == (600, m.INVALID_AXIS, m.INVALID_AXIS, 0)
    assert proof.input_count == 2  # Arm and the key; leases and gates are not inputs
    assert 230 <= proof.last_input_age_ms <= 310
    assert proof.echo_time_boot_ms == pytest.approx(cockpit.now * 1000, abs=110)


def test_no_operator_presence_to_a_foreign_vehicle() -> None:
    cockpit = driving_cockpit(FakeVehicle(autopilot=Autopilot.ARDUPILOT))
    cockpit.run(1.0)
    assert cockpit.vehicle.all(m.RoverOperatorPresence) == []
