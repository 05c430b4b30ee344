"""Several screens of one station: one drives, the others stop, watch and ask."""

from __future__ import annotations

import pytest

from groundstation.intents.driving import DriveKeyDown, DriveKeyUp, EmergencyStop, Stop
from groundstation.intents.session import LEASE_TIMEOUT, GiveUpKeys, RenewLease, ReportKeyReleases, SetKeyGate
from groundstation.intents.union import AnyIntent
from groundstation.intents.vehicle import Arm, Disarm, GiveControl, KeepControl, ReleaseControl, RequestControl, SetMode
from groundstation.station.driving.operator import THAW
from groundstation.station.driving.screen_lease import ANSWER_WITHIN, DEAD_AFTER, Screen, ScreenLease
from tests.groundstation.cockpits import FORWARD, driving_cockpit

REPEAT = 0.03
"""s between repeats of a held key."""


class Bridge:
    """A rover that the first of two screens drives forward; both renew their leases unless they are frozen."""

    def __init__(self) -> None:
        self.cockpit = driving_cockpit()
        self.cockpit.leasing = False
        station = self.cockpit.station
        self.lease = ScreenLease(station.operator, station.driving, station.log)
        self.first = self.lease.join("screen on pts/1", self.now)
        self.do(self.first, SetKeyGate(open=True), ReportKeyReleases())
        self.second = self.lease.join("screen on pts/2", self.now)
        self.frozen: set[Screen] = set()
        self.held: tuple[Screen, DriveKeyDown] | None = None

    @property
    def now(self) -> float:
        return self.cockpit.now

    def do(self, screen: Screen, *intents: AnyIntent) -> None:
        for intent in intents:
            if (allowed := self.lease.filter(screen, intent, self.now)) is not None:
                self.cockpit.do(allowed)

    def run(self, seconds: float) -> None:
        end = self.now + seconds
        while self.now < end:
            for screen in (self.first, self.second):
                if screen not in self.frozen:
                    self.do(screen, RenewLease())
            if self.held is not None:
                self.do(*self.held)
            self.lease.tick(self.now)
            self.cockpit.run(REPEAT)

    @property
    def moves(self) -> bool:
        """The newest demand that the vehicle has got is motion."""
        return bool(self.cockpit.demands()[-1][1])


@pytest.fixture
def bridge() -> Bridge:
    bridge = Bridge()
    bridge.run(0.2)
    assert bridge.moves
    return bridge


def hand_over(bridge: Bridge) -> None:
    bridge.do(bridge.second, RequestControl())
    bridge.do(bridge.first, GiveControl())
    bridge.do(bridge.second, SetKeyGate(open=True))


def test_second_screen_neither_drives_nor_keeps_the_first_alive(bridge: Bridge) -> None:
    view = bridge.lease.view(bridge.second, bridge.now)
    assert (view.driver, view.asks) == ("screen on pts/1", "")
    assert bridge.lease.view(bridge.first, bridge.now).driver == ""
    bridge.frozen.add(bridge.first)
    bridge.held = (bridge.second, FORWARD)
    at = bridge.now
    bridge.run(1.0)
    assert max(t for t, x, _ in bridge.cockpit.demands() if x) - at < LEASE_TIMEOUT + 0.1
    assert not bridge.moves


def test_a_screen_gives_up_the_keys_and_takes_them_back() -> None:
    bridge = Bridge()
    bridge.held = (bridge.first, DriveKeyDown(key="i", throttle=1, steering=0, repeat=True))
    bridge.run(0.2)
    assert bridge.moves
    bridge.do(bridge.first, GiveUpKeys())
    bridge.cockpit.run(REPEAT)
    assert not bridge.moves
    bridge.run(2.0)
    assert not bridge.moves, "the held key counts no more"
    assert bridge.lease.holder is None
    assert bridge.lease.view(bridge.first, bridge.now).driver == "no screen"
    bridge.held = None
    bridge.do(bridge.first, DriveKeyUp(key="i"), FORWARD)
    bridge.run(0.5)
    assert not bridge.moves, "only an explicit key takes them back"
    bridge.do(bridge.first, RequestControl(), SetKeyGate(open=True), DriveKeyUp(key="i"))
    assert bridge.lease.holder is bridge.first
    assert bridge.lease.view(bridge.first, bridge.now).driver == ""
    bridge.run(1.0)
    bridge.held = (bridge.first, FORWARD)
    bridge.run(0.5)
    assert bridge.moves, "without another request: the vehicle was never released"


def test_the_screen_that_gave_up_the_keys_is_the_last_driver(bridge: Bridge) -> None:
    lease, first, second = bridge.lease, bridge.first, bridge.second
    assert (lease.is_last_driver(first), lease.is_last_driver(second)) == (True, False)
    bridge.do(second, GiveUpKeys())
    assert lease.holder is first, "a screen that watches has none to give up"
    bridge.do(first, GiveUpKeys())
    assert (lease.is_last_driver(first), lease.is_last_driver(second)) == (True, False)
    bridge.do(second, RequestControl())
    assert (lease.is_last_driver(first), lease.is_last_driver(second)) == (False, True)
    lease.leave(second, bridge.now)
    assert lease.holder is None
    assert not lease.is_last_driver(first)
    bridge.do(first, RequestControl(), GiveUpKeys())
    lease.leave(first, bridge.now)
    assert not lease.is_last_driver(first)


def test_releasing_control_of_a_vehicle_keeps_the_keys(bridge: Bridge) -> None:
    """Others are asked for a vehicle; the tmux of a screen that nobody sees releases all. No program may drive then."""
    for intent in (ReleaseControl(), ReleaseControl(all=True)):
        bridge.do(bridge.first, intent)
        bridge.run(1.0)
        assert not bridge.moves
        assert bridge.lease.holder is bridge.first


def test_keys_given_up_go_to_the_screen_that_asks(bridge: Bridge) -> None:
    bridge.do(bridge.second, RequestControl())
    bridge.do(bridge.first, GiveUpKeys())
    bridge.cockpit.run(REPEAT)
    assert not bridge.moves
    assert bridge.lease.holder is bridge.second


@pytest.mark.parametrize("intent", [Stop(), EmergencyStop(), Disarm(), SetMode(mode="HOLD")])
def test_a_watching_screen_stops(bridge: Bridge, intent: AnyIntent) -> None:
    bridge.do(bridge.second, intent)
    bridge.run(0.5)
    assert not bridge.moves or not bridge.cockpit.view.armed or bridge.cockpit.view.mode == "HOLD"


def test_a_held_key_does_not_drive_on_after_another_screens_stop(bridge: Bridge) -> None:
    repeats = DriveKeyDown(key="i", throttle=1, steering=0, repeat=True)
    bridge.held = (bridge.first, repeats)
    bridge.run(0.2)
    assert bridge.moves
    bridge.do(bridge.second, Stop())
    bridge.run(1.0)
    assert not bridge.moves
    bridge.held = None
    bridge.do(bridge.first, DriveKeyUp(key="i"), FORWARD)
    bridge.run(0.2)
    assert bridge.moves


@pytest.mark.parametrize(
    "intent", [Stop("another screen is open"), SetKeyGate(open=False), SetMode(mode="AUTO"), FORWARD]
)
def test_what_else_a_watching_screen_does_changes_nothing(bridge: Bridge, intent: AnyIntent) -> None:
    bridge.do(bridge.second, intent, Arm(held=1.0))
    bridge.run(0.3)
    assert bridge.moves
    assert bridge.cockpit.view.mode == "MANUAL"
    assert "Arm of the screen on pts/2 refused: it does not drive" in bridge.cockpit.texts


def test_keys_given_are_neutral_and_only_the_new_screen_drives(bridge: Bridge) -> None:
    at = bridge.now
    hand_over(bridge)
    bridge.held = (bridge.first, FORWARD)
    bridge.run(2.0)
    assert not [x for t, x, _ in bridge.cockpit.demands(at + 0.05) if x]
    bridge.held = None
    bridge.do(bridge.second, FORWARD)
    bridge.run(0.1)
    assert bridge.moves
    assert bridge.lease.view(bridge.first, bridge.now).driver == "screen on pts/2"


def test_key_held_on_new_screen_drives_only_after_a_new_press(bridge: Bridge) -> None:
    """Its terminal reports no releases, other than that of the screen before."""
    bridge.held = (bridge.second, FORWARD)
    bridge.run(0.2)
    hand_over(bridge)
    at = bridge.now
    bridge.run(2.0)
    assert not [x for t, x, _ in bridge.cockpit.demands(at + 0.05) if x]
    bridge.held = None
    bridge.run(1.0)
    bridge.do(bridge.second, FORWARD)
    bridge.run(0.3)
    assert bridge.moves
    bridge.run(1.2)
    assert not bridge.moves, "a timer ends the press"


def test_a_screen_that_ends_is_neutral_and_nobody_drives_unasked(bridge: Bridge) -> None:
    bridge.lease.leave(bridge.first, bridge.now)
    bridge.cockpit.world.settle()
    at = bridge.now
    bridge.frozen.add(bridge.first)
    bridge.run(2.0)
    assert not [x for t, x, _ in bridge.cockpit.demands(at + 0.05) if x]
    assert bridge.lease.view(bridge.second, bridge.now).driver == "no screen"
    bridge.do(bridge.second, RequestControl(), SetKeyGate(open=True))
    bridge.run(THAW + 0.5)
    bridge.do(bridge.second, FORWARD)
    bridge.run(0.1)
    assert bridge.moves


def test_without_an_answer_the_driver_keeps_the_keys(bridge: Bridge) -> None:
    bridge.do(bridge.second, RequestControl())
    view = bridge.lease.view(bridge.first, bridge.now)
    assert view.asks == "screen on pts/2"
    assert view.left == pytest.approx(ANSWER_WITHIN)
    assert bridge.lease.view(bridge.second, bridge.now).waits == pytest.approx(ANSWER_WITHIN)
    bridge.run(ANSWER_WITHIN + 0.2)
    assert bridge.lease.holder is bridge.first
    assert bridge.moves
    assert bridge.lease.view(bridge.second, bridge.now).waits is None


def test_a_driver_whose_keys_do_not_drive_loses_them_unasked(bridge: Bridge) -> None:
    """As over a dead SSH connection, of which its screen knows only that the terminal does not answer."""
    bridge.do(bridge.first, SetKeyGate(open=False, reason="the terminal does not answer"))
    bridge.do(bridge.second, RequestControl())
    bridge.run(ANSWER_WITHIN - 0.5)
    assert bridge.lease.holder is bridge.first
    bridge.run(0.7)
    assert bridge.lease.holder is bridge.second


def test_a_driver_that_stands_still_is_not_asked(bridge: Bridge) -> None:
    bridge.frozen.add(bridge.first)
    bridge.run(DEAD_AFTER + 0.1)
    bridge.do(bridge.second, RequestControl())
    assert bridge.lease.holder is bridge.second


def test_the_driver_keeps_the_keys(bridge: Bridge) -> None:
    bridge.do(bridge.second, RequestControl())
    bridge.do(bridge.first, KeepControl())
    bridge.run(ANSWER_WITHIN + 0.2)
    assert bridge.lease.holder is bridge.first
    assert "the screen on pts/2 does not get the keys" in bridge.cockpit.texts


def test_screens_number_their_requests_apart(bridge: Bridge) -> None:
    assert (bridge.first.first_request, bridge.second.first_request) == (1, 1_000_001)


def test_answers_without_a_request_are_for_other_ground_stations(bridge: Bridge) -> None:
    assert bridge.lease.filter(bridge.first, GiveControl(), bridge.now) == GiveControl()


def test_a_screen_that_watches_gets_the_keys_only_when_it_asks() -> None:
    cockpit = driving_cockpit()
    station = cockpit.station
    lease = ScreenLease(station.operator, station.driving, station.log)
    tab = lease.join("tab", cockpit.now, watches=True)
    for intent in (SetKeyGate(open=True), RenewLease(), FORWARD):
        assert lease.filter(tab, intent, cockpit.now) is None
    assert lease.view(tab, cockpit.now).driver == "no screen"
    assert lease.filter(tab, RequestControl(), cockpit.now) is None
    assert lease.holder is tab
    assert station.operator.sent_demand.neutral, "it begins in neutral"
    assert lease.filter(tab, FORWARD, cockpit.now) is FORWARD
    other = lease.join("another tab", cockpit.now, watches=True)
    lease.leave(tab, cockpit.now)
    assert lease.holder is None
    assert lease.view(other, cockpit.now).driver == "no screen"
