"""Several senders of one system id: what each reported last, and what shows that they are several vehicles."""

from __future__ import annotations

from dialects import messages as m
from groundstation.vehicles.state.senders import Senders
from groundstation.vehicles.state.vehicle_state import VehicleState
from link.core import Peer, Received

ARMED, DISARMED, HOLD, AUTO = 81 | 128, 81, 4, 10
HERE, THERE = Peer(0, ("10.0.0.1", 14550)), Peer(0, ("10.0.0.2", 14550))


def beat(peer: Peer, base: int, mode: int = HOLD, component: int = 1, numbering: int = 0) -> Received:
    message = m.Heartbeat(10, 3, base, mode, 4, 3)
    return Received(message, 1, component, 0, peer, introduced=True, numbering=numbering, clash=numbering > 0)


def booted(peer: Peer, boot_ms: int) -> Received:
    return Received(m.SystemTime(0, boot_ms), 1, 1, 0, peer, introduced=True)


def take(senders: Senders, *received: Received, now: float) -> None:
    for each in received:
        senders.receive(each, now)


def test_a_stop_is_in_doubt_while_one_sender_reports_armed() -> None:
    senders = Senders()
    take(senders, beat(HERE, ARMED, AUTO), beat(THERE, DISARMED), now=1.0)
    assert senders.is_armed(1, 1.0)
    assert senders.find_doubt(1.0) == "the sender at 10.0.0.1:14550 reports ARMED in AUTO"
    take(senders, beat(HERE, DISARMED, AUTO), now=2.0)
    assert senders.find_doubt(2.0) == ""


def test_what_fell_silent_while_armed_is_still_in_doubt() -> None:
    senders = Senders()
    take(senders, beat(HERE, ARMED, AUTO), now=1.0)
    for now in (2.0, 3.0, 4.0, 5.0):
        take(senders, beat(THERE, DISARMED), now=now)
    assert not senders.is_armed(1, 5.0)
    assert senders.find_doubt(5.0) == "the sender at 10.0.0.1:14550 reported ARMED in AUTO 4 s ago"
    take(senders, beat(THERE, DISARMED), now=61.5)
    assert senders.find_doubt(61.5) == ""


def test_vehicle_that_changed_its_address_is_known_by_boot_time() -> None:
    senders = Senders()
    take(senders, beat(HERE, ARMED), booted(HERE, 10_000), now=1.0)
    take(senders, beat(THERE, DISARMED), booted(THERE, 15_200), now=6.0)
    assert senders.find_doubt(6.0) == ""
    assert senders.describe_duplicates(6.0) == ""


def test_another_boot_time_shows_two_vehicles_at_once() -> None:
    senders = Senders()
    take(senders, beat(HERE, DISARMED), beat(THERE, DISARMED), now=1.0)
    assert senders.describe_duplicates(1.0) == ""
    take(senders, booted(HERE, 10_000), booted(THERE, 60_000), now=1.1)
    duplicates = "10.0.0.1:14550 (disarmed in HOLD) and 10.0.0.2:14550 (disarmed in HOLD)"
    assert senders.describe_duplicates(1.1) == duplicates


def test_senders_that_differ_for_longer_than_a_late_link_are_two() -> None:
    senders = Senders()
    for second in range(5):
        take(senders, beat(HERE, ARMED, AUTO), beat(THERE, DISARMED), now=1.0 + second)
        assert senders.differ(1.0 + second)
        assert bool(senders.describe_duplicates(1.0 + second)) == (second >= 4)


def test_a_link_that_is_late_shows_no_second_vehicle() -> None:
    senders = Senders()
    for second in range(8):
        take(senders, beat(HERE, ARMED if second < 3 else DISARMED), now=1.0 + second)
        take(senders, beat(THERE, ARMED if second < 5 else DISARMED), now=1.5 + second)
        assert senders.describe_duplicates(1.5 + second) == ""
    assert not senders.differ(8.5)


def test_two_unique_ids_show_two_vehicles() -> None:
    senders = Senders()
    for peer, uid in ((HERE, 7), (THERE, 8)):
        version = m.AutopilotVersion(0, 0, 0, 0, 0, [0] * 8, [0] * 8, [0] * 8, 0, 0, uid)
        take(senders, beat(peer, DISARMED), Received(version, 1, 1, 0, peer, introduced=True), now=1.0)
    assert senders.describe_duplicates(1.0)


def test_two_vehicles_behind_a_bridge_are_told_apart_by_numbers() -> None:
    senders = Senders()
    take(senders, beat(HERE, DISARMED), now=1.0)
    take(senders, beat(HERE, ARMED, AUTO, numbering=1), beat(HERE, DISARMED, numbering=2), now=2.0)
    assert "(numbering 1)" in senders.find_doubt(2.0)
    assert senders.describe_duplicates(2.0)


def test_each_component_that_claims_the_autopilot_must_report_it() -> None:
    state = VehicleState(1, 1)
    for received in (beat(HERE, DISARMED), beat(HERE, ARMED, AUTO, component=2)):
        state.receive(received, 1.0)
    assert not state.armed
    assert state.senders.components == (1, 2)
    assert state.senders.find_doubt(1.0) == "component 2 at 10.0.0.1:14550 reports ARMED in AUTO"


def test_each_of_several_senders_must_report_anew() -> None:
    senders = Senders()
    take(senders, beat(HERE, ARMED, AUTO), beat(THERE, DISARMED), now=1.0)
    take(senders, beat(HERE, DISARMED, AUTO), now=2.0)
    assert senders.find_doubt(2.0, since=1.5) == "the sender at 10.0.0.2:14550 has not reported since it began"
    take(senders, beat(THERE, ARMED, AUTO), now=2.1)
    assert senders.find_doubt(2.1, since=1.5) == "the sender at 10.0.0.2:14550 reports ARMED in AUTO"
    take(senders, beat(THERE, DISARMED, AUTO), now=2.5)
    assert senders.find_doubt(2.5, since=1.5) == ""


def test_one_vehicle_on_two_paths_need_not_report_on_both() -> None:
    senders = Senders()
    take(senders, beat(HERE, ARMED), beat(THERE, ARMED), booted(HERE, 10_000), booted(THERE, 10_000), now=1.0)
    take(senders, beat(THERE, DISARMED), now=1.4)
    take(senders, beat(HERE, DISARMED), now=2.0)
    assert senders.find_doubt(2.0, since=1.5) == ""


def test_a_flood_of_addresses_grows_no_table() -> None:
    senders = Senders()
    for number in range(5000):
        take(senders, beat(Peer(0, ("10.0.0.9", number)), DISARMED), now=1.0 + number / 1000)
    assert len(senders._senders) <= 16
