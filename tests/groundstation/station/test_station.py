"""The station against a vehicle that does as the test says: driving, stopping, and whose demand is sent."""

from __future__ import annotations

import pytest

from dialects import messages as m
from dialects.enums import Autopilot, SystemState
from dialects.modes import Mode
from groundstation.intents import (
    Arm,
    Disarm,
    DriveKeyDown,
    DriveKeyUp,
    Quit,
    RenewLease,
    ReportKeyReleases,
    RequestControl,
    ScaleLimits,
    SelectVehicle,
    SetKeyGate,
    SetStyle,
    Stop,
)
from groundstation.station.station import Station
from link.core import Peer, Received
from tests.groundstation.fake_vehicle import OURS, Cockpit, FakeVehicle

FORWARD = DriveKeyDown(key="i", throttle=1, steering=0)
LEFT = DriveKeyDown(key="j", throttle=0, steering=-1)


def armed_cockpit(vehicle: FakeVehicle | None = None) -> Cockpit:
    cockpit = Cockpit(vehicle)
    cockpit.run(1.5)
    cockpit.do(Arm())
    cockpit.run(1.5)
    assert cockpit.view.armed
    return cockpit


def driving_cockpit(vehicle: FakeVehicle | None = None) -> Cockpit:
    """Armed, exact keys, `i` held: the vehicle hears 60 %."""
    cockpit = armed_cockpit(vehicle)
    cockpit.do(ReportKeyReleases(), FORWARD)
    cockpit.run(0.5)
    assert cockpit.helm.throttle == pytest.approx(0.6)
    return cockpit


def test_waiting_line_names_the_endpoint() -> None:
    cockpit = Cockpit()
    cockpit.world.cut()
    cockpit.run(1.0)
    assert cockpit.snapshot.waiting == "waiting for a vehicle on udpin:127.0.0.1:14550"
    assert cockpit.snapshot.vehicle is None
    assert cockpit.helm.gate_reason == "no vehicle"


def test_bytes_without_a_vehicle_are_told() -> None:
    cockpit = Cockpit()
    cockpit.vehicle.tick = lambda now: cockpit.vehicle.say(m.SystemTime(0, 0))  # type: ignore[method-assign]
    cockpit.run(2.0)
    waiting = cockpit.snapshot.waiting
    assert waiting is not None
    assert "no vehicle heartbeat yet" in waiting


def test_a_ground_station_is_no_vehicle() -> None:
    cockpit = Cockpit()
    cockpit.vehicle.tick = lambda now: cockpit.vehicle.say(m.Heartbeat(6, 8, 0, 0, 4, 3))  # type: ignore[method-assign]
    cockpit.run(2.0)
    assert cockpit.station.fleet.system_ids == ()


def test_heartbeats_once_a_second_as_ground_station() -> None:
    cockpit = Cockpit()
    cockpit.run(2.0)
    greeted = cockpit.now
    cockpit.run(5.0)
    beats = [each for each in cockpit.vehicle.all(m.Heartbeat) if each[0] > greeted]
    assert len(beats) == 5
    beat = beats[0][1]
    assert (beat.type, beat.autopilot, beat.base_mode, beat.system_status) == (6, 8, 0, SystemState.ACTIVE)


def test_a_vehicle_at_a_new_address_is_greeted_at_once() -> None:
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


def test_a_key_is_sent_at_once_and_then_at_20_hz() -> None:
    cockpit = armed_cockpit()
    before = cockpit.now
    cockpit.do(ReportKeyReleases(), FORWARD)
    cockpit.run(2.0)
    demands = [demand for demand in cockpit.demands(before) if demand[1]]
    assert demands[0][0] - before <= 0.006
    assert {x for _, x, _ in demands} == {600}
    assert {r for _, _, r in demands} == {0}
    assert 38 <= len(demands) <= 43


def test_a_change_is_sent_twice_and_its_repeats_once() -> None:
    cockpit = armed_cockpit()
    before = cockpit.now
    cockpit.do(ReportKeyReleases(), FORWARD)
    cockpit.run(0.3)
    times = [at for at, x, _ in cockpit.demands(before) if x]
    assert times[0] == times[1] < times[2] < times[3]


def test_release_is_neutral_at_once_then_20_hz_for_a_second_then_5_hz() -> None:
    cockpit = driving_cockpit()
    released = cockpit.now
    cockpit.do(DriveKeyUp(key="i"))
    cockpit.run(3.0)
    demands = cockpit.demands(released + 0.001)
    assert demands[0][0] - released <= 0.006
    assert all(x == 0 and r == 0 for _, x, r in demands)
    first_second = [at for at, _, _ in demands if at <= released + 1.0]
    later = [at for at, _, _ in demands if at > released + 1.2]
    assert 18 <= len(first_second) <= 22
    assert 8 <= len(later) <= 10


def test_timer_keys_fall_back_by_themselves() -> None:
    cockpit = armed_cockpit()
    pressed = cockpit.now
    cockpit.do(FORWARD)
    cockpit.run(2.0)
    driven = [at for at, x, _ in cockpit.demands(pressed) if x]
    assert driven
    assert max(driven) <= pressed + 0.75 + 0.03


def test_nothing_is_sent_to_a_disarmed_vehicle() -> None:
    cockpit = Cockpit()
    cockpit.run(1.5)
    cockpit.do(ReportKeyReleases(), FORWARD)
    cockpit.run(1.0)
    assert cockpit.demands() == []
    assert cockpit.helm.gate_reason == "disarmed"
    assert cockpit.helm.held == ("i",)


def test_a_key_held_while_arming_does_not_drive() -> None:
    cockpit = Cockpit()
    cockpit.run(1.5)
    cockpit.do(ReportKeyReleases(), FORWARD, Arm())
    cockpit.run(2.0)
    assert cockpit.view.armed
    assert all(x == 0 for _, x, _ in cockpit.demands())
    cockpit.do(DriveKeyUp(key="i"), FORWARD)
    cockpit.run(0.1)
    assert cockpit.demands()[-1][1] == 600


def test_nothing_is_sent_while_another_station_drives() -> None:
    vehicle = FakeVehicle(driver=254)
    vehicle.armed = True
    cockpit = Cockpit(vehicle)
    cockpit.run(1.5)
    cockpit.do(ReportKeyReleases(), FORWARD)
    cockpit.run(1.0)
    assert cockpit.demands() == []
    assert cockpit.helm.gate_reason == "GCS 254 is in control"
    cockpit.do(RequestControl())
    cockpit.run(1.0)
    assert cockpit.view.in_control
    cockpit.do(DriveKeyUp(key="i"), FORWARD)
    cockpit.run(0.1)
    assert cockpit.demands()[-1][1] == 600


def test_stop_wins_over_a_held_key_until_it_is_pressed_again() -> None:
    cockpit = driving_cockpit()
    stopped = cockpit.now
    cockpit.do(Stop())
    cockpit.run(0.5)
    assert all(x == 0 for _, x, _ in cockpit.demands(stopped + 0.001))
    cockpit.do(DriveKeyDown(key="i", throttle=1, steering=0, repeat=True))  # the key is still down and repeats
    cockpit.run(0.2)
    assert cockpit.demands()[-1][1] == 0


def test_speed_keys_change_the_demand_but_never_make_one() -> None:
    cockpit = armed_cockpit()
    cockpit.do(ScaleLimits(throttle=1.1, steering=1.1))
    cockpit.run(0.5)
    assert all(x == 0 for _, x, _ in cockpit.demands())
    cockpit.do(ReportKeyReleases(), FORWARD)
    cockpit.run(0.1)
    assert cockpit.demands()[-1][1] == 660


def test_closing_the_gate_is_neutral_at_once() -> None:
    cockpit = driving_cockpit()
    closed = cockpit.now
    cockpit.do(SetKeyGate(open=False, reason="help is open"))
    cockpit.run(0.3)
    demands = cockpit.demands(closed + 0.001)
    assert demands
    assert demands[0][0] - closed <= 0.006
    assert all(x == 0 for _, x, _ in demands)
    assert cockpit.helm.gate_reason == "help is open"
    assert cockpit.helm.held == ()
    cockpit.do(FORWARD, SetKeyGate(open=True), DriveKeyDown(key="i", throttle=1, steering=0, repeat=True))
    cockpit.run(0.3)
    assert cockpit.demands()[-1][1] == 0, "a key pressed behind a closed gate must not drive after it opened"


def test_a_key_that_repeats_from_before_the_gate_opened_does_not_drive() -> None:
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
    cockpit.run(0.5)
    cockpit.do(FORWARD)
    cockpit.run(0.2)
    assert cockpit.demands()[-1][1] == 600


def test_frozen_screen_is_neutral_within_half_a_second_then_silence() -> None:
    cockpit = driving_cockpit()
    frozen = cockpit.now
    cockpit.leasing = False
    cockpit.run(5.0)
    moving = [at for at, x, _ in cockpit.demands(frozen) if x]
    assert max(moving) - frozen <= 0.45
    neutral = [at for at, x, _ in cockpit.demands(max(moving) + 0.001) if x == 0]
    assert len(set(neutral)) == 5
    assert max(at for at, _ in cockpit.vehicle.all(m.Heartbeat)) - frozen <= 1.1
    assert not cockpit.helm.sending
    assert cockpit.helm.held == ()


def test_keys_typed_at_a_frozen_screen_do_not_drive_when_it_thaws() -> None:
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


def test_quit_sends_neutral_five_times_and_finishes() -> None:
    cockpit = driving_cockpit()
    quitting = cockpit.now
    assert not cockpit.station.finished
    cockpit.do(Quit())
    cockpit.run(0.15)
    assert not cockpit.station.finished
    cockpit.run(0.15)
    assert cockpit.station.finished
    demands = cockpit.demands(quitting + 0.001)
    assert {x for _, x, _ in demands} == {0}
    assert len({at for at, _, _ in demands}) == 5
    cockpit.run(2.0)
    assert cockpit.demands(quitting + 0.001) == demands
    assert not [at for at, _ in cockpit.vehicle.all(m.Heartbeat) if at > quitting + 0.3]


def test_quit_without_a_drive_is_finished_at_once() -> None:
    cockpit = Cockpit()
    cockpit.run(1.0)
    cockpit.do(Quit())
    assert cockpit.station.finished


def test_a_key_held_over_a_lost_link_has_to_be_pressed_anew() -> None:
    cockpit = driving_cockpit()
    cockpit.world.cut()
    cockpit.run(5.0)
    assert not cockpit.view.alive
    assert cockpit.helm.gate_reason == "Rover 1: link lost"
    cockpit.world.cut(False)
    back = cockpit.now
    cockpit.run(2.0)
    assert cockpit.view.alive
    assert all(x == 0 for _, x, _ in cockpit.demands(back))
    assert "Rover 1: link lost for 2.5 s" in cockpit.texts
    assert len([text for text in cockpit.texts if text.startswith("Rover 1: link back after")]) == 1
    cockpit.do(DriveKeyUp(key="i"), FORWARD)
    cockpit.run(0.1)
    assert cockpit.demands()[-1][1] == 600


def test_hold_mode_keeps_the_keys_from_driving() -> None:
    cockpit = driving_cockpit()
    cockpit.vehicle.mode = Mode.HOLD
    cockpit.run(1.5)
    assert cockpit.helm.gate_reason == "mode HOLD"
    assert cockpit.demands()[-1][1] == 0


def test_disarm_stops_at_once_and_then_says_nothing() -> None:
    cockpit = driving_cockpit()
    at = cockpit.now
    cockpit.do(Disarm())
    cockpit.run(3.0)
    assert not cockpit.view.armed
    demands = cockpit.demands(at + 0.001)
    assert all(x == 0 for _, x, _ in demands)
    assert demands[-1][0] - at < 0.5


def test_proof_of_life_goes_before_each_demand_to_a_vehicle_that_knows_it() -> None:
    cockpit = armed_cockpit()
    cockpit.run(0.5)
    cockpit.do(ReportKeyReleases(), FORWARD)
    cockpit.run(0.3)
    tail = [
        message
        for _, message in cockpit.vehicle.heard
        if isinstance(message, (m.RoverOperatorPresence, m.ManualControl))
    ]
    assert [type(message) for message in tail[-4:]] == [m.RoverOperatorPresence, m.ManualControl] * 2
    proof = tail[-2]
    assert isinstance(proof, m.RoverOperatorPresence)
    assert (proof.target_system, proof.target_component, proof.session_id, proof.flags) == (1, 1, 7, 3)
    assert proof.input_count == 2  # Arm and the key; leases and gates are no inputs
    assert 230 <= proof.last_input_age_ms <= 310
    assert proof.echo_time_boot_ms == pytest.approx(cockpit.now * 1000, abs=110)


def test_no_proof_of_life_to_a_vehicle_that_does_not_know_it() -> None:
    cockpit = driving_cockpit(FakeVehicle(autopilot=Autopilot.ARDUPILOT, driver=None))
    cockpit.run(1.0)
    assert cockpit.vehicle.all(m.RoverOperatorPresence) == []


def test_ardupilot_gets_its_own_axes() -> None:
    cockpit = armed_cockpit(FakeVehicle(autopilot=Autopilot.ARDUPILOT, driver=None))
    cockpit.do(ReportKeyReleases(), FORWARD, LEFT)
    cockpit.run(0.1)
    _, message = cockpit.vehicle.all(m.ManualControl)[-1]
    assert (message.z, message.y, message.x, message.r) == (600, -600, 32767, 32767)
    assert cockpit.view.name == "ArduPilot rover 1"
    assert cockpit.view.driver is None
    assert cockpit.view.in_control


def test_px4_neutral_is_500() -> None:
    cockpit = armed_cockpit(FakeVehicle(autopilot=Autopilot.PX4, driver=None))
    cockpit.do(ReportKeyReleases(), FORWARD)
    cockpit.run(0.1)
    assert cockpit.vehicle.all(m.ManualControl)[-1][1].z == 800
    cockpit.do(Stop())
    cockpit.run(0.1)
    assert cockpit.vehicle.all(m.ManualControl)[-1][1].z == 500


def test_latency_is_that_of_a_changed_demand() -> None:
    cockpit = armed_cockpit()
    cockpit.world.up.delay = cockpit.world.down.delay = 0.02
    cockpit.run(1.0)
    cockpit.do(ReportKeyReleases(), FORWARD)
    cockpit.run(0.5)
    assert cockpit.view.latency == pytest.approx(0.04, abs=0.011)
    assert cockpit.view.demand == (0.6, 0.0)


def test_round_trip_and_loss_are_shown() -> None:
    cockpit = Cockpit()
    cockpit.world.up.delay = cockpit.world.down.delay = 0.03
    cockpit.run(6.0)
    (link,) = cockpit.snapshot.links
    assert link.round_trip == pytest.approx(0.06, abs=0.011)
    assert link.loss == 0.0
    assert link.rate > 0


def test_ardupilot_settings_that_let_it_drive_on_are_warned_of() -> None:
    vehicle = FakeVehicle(autopilot=Autopilot.ARDUPILOT, driver=None)
    vehicle.parameters = {"RC_OVERRIDE_TIME": 3.0, "FS_GCS_ENABLE": 0.0, "FS_THR_ENABLE": 1.0, "MAV_GCS_SYSID": 255.0}
    cockpit = Cockpit(vehicle)
    cockpit.run(3.0)
    assert cockpit.view.warnings == (
        "RC_OVERRIDE_TIME 3: drives on for 3 s when the link is lost",
        "FS_GCS_ENABLE 0: no failsafe when the ground station is lost",
    )


def test_styles_are_told_and_latch_drives_without_a_held_key() -> None:
    cockpit = armed_cockpit()
    cockpit.do(SetStyle(style="next"), FORWARD)
    cockpit.run(3.0)
    assert cockpit.helm.style == "latch"
    assert cockpit.demands()[-1][1] == 600
    assert "drive style latch" in cockpit.texts
    cockpit.do(Stop())
    cockpit.run(0.1)
    assert cockpit.demands()[-1][1] == 0


def test_messages_come_with_rates() -> None:
    cockpit = Cockpit()
    cockpit.run(5.0)
    rates = {(rate.name, rate.sent): rate for rate in cockpit.snapshot.messages}
    assert rates["HEARTBEAT", False].rate == pytest.approx(1.0, abs=0.4)
    assert rates["HEARTBEAT", True].count >= 5


def test_orders_without_a_vehicle_are_answered_in_words() -> None:
    cockpit = Cockpit()
    cockpit.world.cut()
    cockpit.do(Arm())
    assert "no vehicle yet" in cockpit.texts


def test_an_unknown_vehicle_cannot_be_selected() -> None:
    cockpit = driving_cockpit()
    cockpit.do(SelectVehicle(system=9))
    cockpit.run(0.2)
    assert cockpit.view.system == 1
    assert cockpit.demands()[-1][1] == 0, "looking for another vehicle lets go of this one"


def test_thirty_percent_loss_does_not_stop_the_stream() -> None:
    cockpit = Cockpit(loss=0.3)
    cockpit.run(3.0)
    cockpit.do(Arm())
    cockpit.run(3.0)
    assert cockpit.view.armed
    cockpit.do(ReportKeyReleases(), FORWARD)
    start = cockpit.now
    cockpit.run(10.0)
    heard = len([1 for _, x, _ in cockpit.demands(start) if x == 600])
    assert 110 <= heard <= 170
    assert cockpit.view.driver == OURS
