"""Driving by the picture of a camera: keys drive while it is fresh. Each stop first sees the wheels driven."""

from __future__ import annotations

import math

import pytest

from groundstation.intents.driving import CLOCK_ERROR, OLDEST_PICTURE, DriveByPicture, DriveKeyUp, EmergencyStop
from groundstation.intents.session import LEASE_TIMEOUT, SetKeyGate
from groundstation.station.driving.picture_lock import REASON, PictureLock
from tests.groundstation.cockpits import FORWARD, Cockpit, driving_cockpit


def watch(cockpit: Cockpit, seconds: float, *, delay: float = 0.1) -> None:
    """See ten pictures a second, each so old when it comes."""
    end = cockpit.now + seconds
    while cockpit.now < end:
        cockpit.do(DriveByPicture(drives=True, taken_at=cockpit.now - delay))
        cockpit.run(0.1)


def seeing_cockpit() -> Cockpit:
    """Driven by fresh pictures."""
    cockpit = driving_cockpit()
    watch(cockpit, 2.0)
    assert cockpit.operator.throttle == pytest.approx(0.6)
    assert cockpit.demands()[-1][1] == 600
    return cockpit


def test_keys_do_not_drive_by_an_old_picture() -> None:
    cockpit = seeing_cockpit()
    began = cockpit.now - 0.2  # when the newest picture was taken
    cockpit.run(0.29)
    assert cockpit.operator.throttle == pytest.approx(0.6)
    cockpit.run(0.05)
    assert cockpit.station.operator.sent_demand.neutral
    assert cockpit.operator.gate_reason == REASON
    assert next(at for at, x, _ in cockpit.demands(began + 0.3) if x == 0) - began < OLDEST_PICTURE + 0.05
    assert cockpit.demands()[-1][1] == 0


def test_a_fresh_picture_alone_does_not_drive_again() -> None:
    cockpit = seeing_cockpit()
    cockpit.run(1.0)
    assert cockpit.operator.throttle == 0.0
    watch(cockpit, 1.0)
    assert cockpit.operator.gate_open
    assert cockpit.operator.throttle == 0.0, "the key is held from before"
    cockpit.do(DriveKeyUp("i"), FORWARD)
    watch(cockpit, 0.5)
    assert cockpit.operator.throttle == pytest.approx(0.6)


def test_a_key_pressed_while_it_is_old_does_not_drive_later() -> None:
    cockpit = seeing_cockpit()
    cockpit.run(1.0)
    cockpit.do(DriveKeyUp("i"), FORWARD)
    assert cockpit.operator.ignored == REASON
    watch(cockpit, 0.3)
    assert cockpit.operator.throttle == 0.0


@pytest.mark.parametrize("taken_at", [0.0, -math.inf, math.inf, math.nan, 1e9])
def test_a_time_that_is_none_locks(taken_at: float) -> None:
    cockpit = seeing_cockpit()
    cockpit.do(DriveByPicture(drives=True, taken_at=taken_at))
    assert cockpit.station.operator.sent_demand.neutral
    assert cockpit.operator.gate_reason == REASON


def test_who_drives_by_eye_needs_no_picture() -> None:
    cockpit = seeing_cockpit()
    cockpit.do(DriveByPicture(drives=False))
    cockpit.run(2.0)
    assert cockpit.operator.throttle == pytest.approx(0.6)


def test_a_late_picture_of_a_slow_network_locks_as_well() -> None:
    cockpit = seeing_cockpit()
    watch(cockpit, 1.0, delay=OLDEST_PICTURE + 0.01)
    assert cockpit.operator.throttle == 0.0


def test_other_reasons_come_first_and_stops_pass() -> None:
    cockpit = seeing_cockpit()
    cockpit.do(SetKeyGate(open=False, reason="another screen is open"))
    cockpit.run(1.0)
    assert cockpit.operator.gate_reason == "another screen is open"
    cockpit.do(SetKeyGate(open=True), EmergencyStop())
    cockpit.run(0.5)
    assert not cockpit.view.armed


def test_clocks_may_differ_a_little() -> None:
    lock = PictureLock()
    assert lock.refusal(5.0) is None
    assert lock.ends_at is None
    lock.handle(DriveByPicture(drives=True, taken_at=5.0 + CLOCK_ERROR / 2), 5.0)
    assert lock.refusal(5.0 + OLDEST_PICTURE - 0.01) is None
    assert lock.refusal(5.0 + OLDEST_PICTURE + 0.01) == REASON


def test_a_newer_picture_lets_keys_drive_on_and_sends_nothing() -> None:
    cockpit = seeing_cockpit()
    station = cockpit.station
    for _ in range(20):
        newest = cockpit.now - 0.1
        assert station.prolong_picture(DriveByPicture(drives=True, taken_at=newest), cockpit.now)
        assert not station.messages_to_send()
        cockpit.run(0.1)
        assert cockpit.operator.throttle == pytest.approx(0.6)
    cockpit.run(newest + OLDEST_PICTURE - cockpit.now + 0.05)
    assert not cockpit.operator.throttle
    assert cockpit.demands()[-1][1] == 0
    assert not station.prolong_picture(DriveByPicture(drives=True, taken_at=cockpit.now), cockpit.now), "it was locked"


def test_what_changes_more_than_the_time_is_an_intent() -> None:
    cockpit = seeing_cockpit()
    for drives, taken_at in ((False, cockpit.now), (True, 0.0), (True, math.nan), (True, cockpit.now - 0.4)):
        assert not cockpit.station.prolong_picture(DriveByPicture(drives=drives, taken_at=taken_at), cockpit.now)
    cockpit.leasing = False
    late = cockpit.now + LEASE_TIMEOUT + 0.05
    assert not cockpit.station.prolong_picture(DriveByPicture(drives=True, taken_at=late), late), (
        "the lease has run out"
    )
    by_eye = driving_cockpit()
    assert not by_eye.station.prolong_picture(DriveByPicture(drives=True, taken_at=by_eye.now), by_eye.now)
