"""Whether the keys drive the vehicle, and the demands that are sent."""

from __future__ import annotations

from itertools import pairwise

import pytest

from dialects import messages as m
from dialects.enums import Autopilot
from dialects.modes import Mode
from groundstation.intents.driving import DriveKeyUp, Stop
from groundstation.intents.session import ReportKeyReleases
from groundstation.intents.vehicle import Arm, Disarm, RequestControl
from tests.fakes.vehicle import FakeVehicle
from tests.groundstation.cockpits import FORWARD, LEFT, OURS, Cockpit, armed_cockpit, driving_cockpit


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


def test_a_copy_follows_a_change_and_none_its_repeats() -> None:
    cockpit = armed_cockpit()
    before = cockpit.now
    cockpit.do(ReportKeyReleases(), FORWARD)
    cockpit.run(0.3)
    proofs = [at for at, message in cockpit.vehicle.all(m.RoverOperatorPresence) if at >= before and message.x == 600]
    first, copy, *repeats = proofs
    assert 0.003 <= copy - first <= 0.01
    assert all(0.035 <= later - earlier <= 0.075 for earlier, later in pairwise([first, *repeats])), repeats
    assert [at for at, x, _ in cockpit.demands(before) if x] == [first, *repeats], "a copy is the proof alone"


def test_a_key_pressed_during_a_stop_drives_only_after_a_neutral() -> None:
    cockpit = driving_cockpit()
    station, now = cockpit.station, cockpit.now
    station.messages_to_send()
    for intent in (Stop(), FORWARD):  # as the station reads them, before it sends
        station.handle_intent(intent, now)
    sent = [each.message for each in station.messages_to_send()]
    assert {message.x for message in sent if isinstance(message, (m.ManualControl, m.RoverOperatorPresence))} == {0}
    station.act(now + 0.01)
    later = [each.message for each in station.messages_to_send()]
    assert [message.x for message in later if isinstance(message, m.ManualControl)] == [600]


def test_a_copy_carries_what_the_keys_demand_when_it_is_sent() -> None:
    cockpit = driving_cockpit()
    released = cockpit.now
    cockpit.do(DriveKeyUp(key="i"))
    cockpit.do(FORWARD)
    cockpit.do(DriveKeyUp(key="i"))
    cockpit.run(0.2)
    assert {x for at, x, _ in cockpit.demands(released + 0.006)} == {0}


def test_no_copy_follows_a_screen_that_hangs() -> None:
    cockpit = driving_cockpit()
    cockpit.leasing = False
    cockpit.run(0.4)
    assert cockpit.demands()[-1][1] == 0
    silent = cockpit.now
    cockpit.do(FORWARD)
    cockpit.run(0.4)
    assert all(x == 0 for _, x, _ in cockpit.demands(silent))


def test_release_is_neutral_at_once_then_20_hz_for_1_s_then_5_hz() -> None:
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
    assert cockpit.operator.gate_reason == "disarmed"
    assert cockpit.operator.held == ("i",)


def test_a_key_held_while_arming_does_not_drive() -> None:
    cockpit = Cockpit()
    cockpit.run(1.5)
    cockpit.do(ReportKeyReleases(), FORWARD, Arm(held=1.0))
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
    assert cockpit.operator.gate_reason == "GCS 254 is in control"
    cockpit.do(RequestControl())
    cockpit.run(1.0)
    assert cockpit.view.in_control
    cockpit.do(DriveKeyUp(key="i"), FORWARD)
    cockpit.run(0.1)
    assert cockpit.demands()[-1][1] == 600


def test_a_key_held_over_a_lost_link_has_to_be_pressed_anew() -> None:
    cockpit = driving_cockpit()
    cockpit.world.cut()
    cockpit.run(5.0)
    assert not cockpit.view.alive
    assert cockpit.operator.gate_reason == "Rover 1: link lost"
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
    assert cockpit.operator.gate_reason == "mode HOLD"
    assert cockpit.demands()[-1][1] == 0


def test_disarm_stops_at_once_and_then_sends_nothing() -> None:
    cockpit = driving_cockpit()
    at = cockpit.now
    cockpit.do(Disarm())
    cockpit.run(3.0)
    assert not cockpit.view.armed
    demands = cockpit.demands(at + 0.001)
    assert all(x == 0 for _, x, _ in demands)
    assert demands[-1][0] - at < 0.5


def test_ardupilot_gets_its_own_axes() -> None:
    cockpit = armed_cockpit(FakeVehicle(autopilot=Autopilot.ARDUPILOT))
    cockpit.do(ReportKeyReleases(), FORWARD, LEFT)
    cockpit.run(0.1)
    _, message = cockpit.vehicle.all(m.ManualControl)[-1]
    assert (message.z, message.y, message.x, message.r) == (600, -600, 32767, 32767)
    assert cockpit.view.name == "ArduPilot rover 1"
    assert cockpit.view.driver is None
    assert cockpit.view.in_control


def test_px4_neutral_is_500() -> None:
    cockpit = armed_cockpit(FakeVehicle(autopilot=Autopilot.PX4))
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


def test_thirty_percent_loss_does_not_stop_the_stream() -> None:
    cockpit = Cockpit(loss=0.3)
    cockpit.run(3.0)
    cockpit.do(Arm(held=1.0))
    cockpit.run(3.0)
    assert cockpit.view.armed
    cockpit.do(ReportKeyReleases(), FORWARD)
    start = cockpit.now
    cockpit.run(10.0)
    heard = len([1 for _, x, _ in cockpit.demands(start) if x == 600])
    assert 110 <= heard <= 170
    assert cockpit.view.driver == OURS
