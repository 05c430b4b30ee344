"""The gamepad in the station: a demand as that of keys, by the same rules. Each stop first sees the wheels driven."""

from __future__ import annotations

import math

import pytest

from groundstation.intents.driving import PAD, DriveKeyUp, DrivePad, EmergencyStop, ReleasePad, Stop
from groundstation.intents.session import ReportKeyReleases, SetKeyGate
from groundstation.intents.union import AnyIntent
from groundstation.intents.vehicle import Disarm, SelectNextVehicle
from groundstation.station.driving.screen_lease import ScreenLease
from tests.groundstation.cockpits import FORWARD, Cockpit, armed_cockpit, driving_cockpit

PERIOD = 0.05


def push(cockpit: Cockpit, seconds: float, throttle: float = 1.0, steering: float = 0.0, *, again: bool = True) -> None:
    """Press the dead-man button and hold it for so long; without `again` it is held already."""
    end = cockpit.now + seconds
    while cockpit.now < end:
        cockpit.do(DrivePad(throttle, steering, cockpit.now, repeat=not again))
        cockpit.run(PERIOD)
        again = False


def go_on(cockpit: Cockpit, seconds: float, throttle: float = 1.0, steering: float = 0.0) -> None:
    """Hold the dead-man button on."""
    push(cockpit, seconds, throttle, steering, again=False)


def driven_cockpit() -> Cockpit:
    """Armed, and driven with the gamepad at the limit of 60 %."""
    cockpit = armed_cockpit()
    push(cockpit, 0.5)
    assert cockpit.operator.throttle == pytest.approx(0.6)
    assert cockpit.operator.held == (PAD,)
    return cockpit


def test_it_drives_within_the_limits_and_stops_with_the_button() -> None:
    cockpit = driven_cockpit()
    go_on(cockpit, 0.2, throttle=-0.5, steering=1.0)
    assert cockpit.operator.throttle == pytest.approx(-0.3)
    assert cockpit.operator.steering == pytest.approx(0.6)
    cockpit.do(ReleasePad())
    assert cockpit.station.operator.sent_demand.neutral, "at once"
    push(cockpit, 0.2)
    assert cockpit.operator.throttle == pytest.approx(0.6)


def test_a_button_whose_press_was_not_seen_does_not_drive() -> None:
    cockpit = armed_cockpit()
    go_on(cockpit, 1.0)
    assert cockpit.operator.throttle == 0.0
    assert cockpit.operator.ignored


def test_a_hung_reader_is_neutral_and_drives_again_after_a_press() -> None:
    cockpit = driven_cockpit()
    cockpit.run(0.25)
    assert cockpit.operator.throttle == 0.0
    go_on(cockpit, 1.0)
    assert cockpit.operator.throttle == 0.0
    cockpit.do(ReleasePad())
    push(cockpit, 0.2)
    assert cockpit.operator.throttle == pytest.approx(0.6)


def test_frames_that_were_read_long_ago_do_not_drive() -> None:
    cockpit = driven_cockpit()
    for _ in range(20):
        cockpit.do(DrivePad(1.0, 0.0, cockpit.now - 0.25, repeat=True))
        cockpit.run(PERIOD)
    cockpit.do(DrivePad(1.0, 0.0, cockpit.now - 0.25), DrivePad(1.0, 0.0, math.nan))
    assert cockpit.operator.throttle == 0.0


@pytest.mark.parametrize("wrong", [math.nan, math.inf, -math.inf])
def test_no_number_drives_nothing(wrong: float) -> None:
    cockpit = driven_cockpit()
    go_on(cockpit, 0.1, throttle=wrong)
    assert cockpit.operator.throttle == 0.0
    cockpit = driven_cockpit()
    go_on(cockpit, 0.1, throttle=0.5, steering=wrong)
    assert cockpit.operator.steering == 0.0


@pytest.mark.parametrize(
    "stop",
    [Stop(), Stop("another screen is open"), EmergencyStop(), Disarm(), SelectNextVehicle()],
    ids=lambda intent: type(intent).__name__,
)
def test_every_stop_ends_it_until_the_button_is_released(stop: AnyIntent) -> None:
    cockpit = driven_cockpit()
    cockpit.do(stop)
    go_on(cockpit, 1.0)
    assert cockpit.operator.throttle == 0.0


def test_a_closed_gate_ends_it_and_an_open_one_needs_a_new_press() -> None:
    cockpit = driven_cockpit()
    cockpit.do(SetKeyGate(open=False, reason="another screen is open"))
    go_on(cockpit, 0.5)
    assert cockpit.operator.throttle == 0.0
    cockpit.do(SetKeyGate(open=True))
    go_on(cockpit, 1.0)
    assert cockpit.operator.throttle == 0.0
    cockpit.do(ReleasePad())
    push(cockpit, 0.2)
    assert cockpit.operator.throttle == pytest.approx(0.6)


def test_a_frozen_screen_ends_it_although_its_frames_go_on() -> None:
    cockpit = driven_cockpit()
    cockpit.leasing = False
    go_on(cockpit, 0.5)
    assert cockpit.operator.throttle == 0.0
    cockpit.leasing = True
    go_on(cockpit, 1.0)
    assert cockpit.operator.throttle == 0.0


def test_the_one_that_begins_last_drives() -> None:
    cockpit = driving_cockpit()
    cockpit.do(ReleasePad())
    push(cockpit, 0.3, throttle=-1.0)
    assert cockpit.operator.throttle == pytest.approx(-0.6)
    assert cockpit.operator.held == (PAD,)
    cockpit.do(ReleasePad())
    cockpit.run(0.2)
    assert cockpit.operator.throttle == 0.0, "the key that is still held was pressed before"
    push(cockpit, 0.3, throttle=-1.0)
    cockpit.do(ReportKeyReleases(), DriveKeyUp(key="i"), FORWARD)
    go_on(cockpit, 0.3, throttle=-1.0)
    assert cockpit.operator.throttle == pytest.approx(0.6)
    assert cockpit.operator.held == ("i",)


def test_the_gamepad_of_a_screen_that_watches_drives_nothing() -> None:
    cockpit = driven_cockpit()
    lease = ScreenLease(cockpit.station.operator, cockpit.station.driving, cockpit.station.log)
    lease.join("first", cockpit.now)
    second = lease.join("second", cockpit.now)
    texts = len(cockpit.snapshot.texts)
    assert lease.filter(second, DrivePad(1.0, 0.0, cockpit.now), cockpit.now) is None
    assert lease.filter(second, ReleasePad(), cockpit.now) is None
    cockpit.run(0.1)
    assert len(cockpit.snapshot.texts) == texts, "no line for each of 20 frames a second"
