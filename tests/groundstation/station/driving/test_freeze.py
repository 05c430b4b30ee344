"""A station process that was frozen while a key is held: nothing resumes, whichever event is served first."""

from __future__ import annotations

import random
from collections.abc import Callable

import pytest

from dialects import messages as m
from dialects.enums import Autopilot, Severity, SystemState, VehicleType
from dialects.modes import Mode, base_mode
from groundstation.input.style import Style
from groundstation.intents.driving import DriveKeyDown, DriveKeyUp
from groundstation.intents.session import (
    LEASE_TIMEOUT,
    QUITTING,
    REST_LEASE_TIMEOUT,
    SUSPENDED,
    Quit,
    RenewLease,
    ReportKeyReleases,
    SetKeyGate,
)
from groundstation.intents.union import AnyIntent
from groundstation.station.driving.operator import Lapse, OperatorSession
from groundstation.station.station import Station
from link.core import Peer, Received

FORWARD = DriveKeyDown(key="i", throttle=1, steering=0)
REPEAT = DriveKeyDown(key="i", throttle=1, steering=0, repeat=True)
LAPSE = "display not responding for"
TICK = 0.025


def armed_and_ours() -> list[Received]:
    """What a rover reports that is armed and in our control."""
    flags = base_mode(Mode.MANUAL, armed=True)
    heartbeat = m.Heartbeat(VehicleType.GROUND_ROVER, Autopilot.GENERIC, flags, Mode.MANUAL, SystemState.ACTIVE, 3)
    messages = (heartbeat, m.ControlStatus(1, 255, [0] * 10))
    return [Received(message, 1, 1, 0, Peer(0, "vehicle"), introduced=True) for message in messages]


class HeldKey:
    """A station with an armed rover and `i` held; the screen, the key and the rover go on while the station sleeps."""

    def __init__(self, *, releases: bool) -> None:
        self.now = 100.0
        self.station = Station(["memory"], now=self.now)
        self.key: AnyIntent = REPEAT if releases else FORWARD
        self.do(RenewLease(), SetKeyGate(open=True), *([ReportKeyReleases()] if releases else []))
        self.beat()
        for _ in range(20):
            self.step()
        self.do(DriveKeyUp(key="i"), FORWARD) if releases else self.do(FORWARD)
        for _ in range(16):
            self.step(self.key)
        assert self.moves() or self.throttle > 0

    def do(self, *intents: AnyIntent) -> None:
        """Carry out intents as the process does, which takes a renewal of a lease that holds for no more than that."""
        for intent in intents:
            if not (isinstance(intent, RenewLease) and self.station.renew_lease(self.now)):
                self.station.handle_intent(intent, self.now)

    def beat(self) -> None:
        for received in armed_and_ours():
            self.station.receive(received, self.now)

    def step(self, *intents: AnyIntent) -> None:
        """One period of the station's loop."""
        self.now += TICK
        self.beat()
        self.do(RenewLease(), *intents)
        self.station.tick(self.now)

    def moves(self) -> bool:
        """Return whether a demand other than neutral was queued since the last call."""
        sent = [each.message for each in self.station.messages_to_send()]
        return any(isinstance(each, m.ManualControl) and each.x != 0 for each in sent)

    @property
    def throttle(self) -> float:
        return self.station.snapshot(self.now, self.now).operator.throttle

    @property
    def ignored(self) -> str:
        return self.station.snapshot(self.now, self.now).operator.ignored

    def lapses(self) -> int:
        lines = self.station.snapshot(self.now, self.now).texts
        return sum(line.count for line in lines if line.text.startswith(LAPSE))


def _tick(held: HeldKey) -> None:
    held.station.tick(held.now)


def _lease(held: HeldKey) -> None:
    held.do(RenewLease())


def _key(held: HeldKey) -> None:
    held.do(held.key)


def _gate(held: HeldKey) -> None:
    held.do(SetKeyGate(open=True))


ORDERS: tuple[tuple[Callable[[HeldKey], None], ...], ...] = (
    (_tick, _lease, _key), (_lease, _key, _tick), (_key, _lease, _tick), (_gate, _lease, _key, _tick),
)  # fmt: skip


@pytest.mark.parametrize("releases", [False, True], ids=["timers", "releases"])
@pytest.mark.parametrize("order", ORDERS, ids=["tick first", "lease first", "key first", "gate first"])
def test_after_a_freeze_nothing_resumes_in_1000_of_1000_tries(
    order: tuple[Callable[[HeldKey], None], ...], releases: bool
) -> None:
    chance = random.Random(12)
    for _ in range(125):  # of 8 combinations
        held = HeldKey(releases=releases)
        held.moves()
        held.now += chance.uniform(0.31, 8.0)
        if chance.random() < 0.5:
            held.beat()
        for event in order:
            event(held)
            assert not held.moves()
        for _ in range(50):
            held.step(held.key)
            assert not held.moves()
        assert held.throttle == 0.0
        assert held.lapses() == 1, "one lapse, one line"


@pytest.mark.parametrize("event", [_lease, _key, _tick], ids=["lease", "key", "tick"])
def test_a_new_press_after_the_freeze_drives(event: Callable[[HeldKey], None]) -> None:
    held = HeldKey(releases=True)
    held.now += 3.0
    event(held)
    for _ in range(40):
        held.step(REPEAT)
    held.moves()
    held.do(DriveKeyUp(key="i"), FORWARD)
    held.step()
    assert held.moves()


def test_renewing_expired_lease_releases_keys_and_is_told_once() -> None:
    session = OperatorSession(Style.HOLD, 0.6)
    session.renew_lease(100.0)
    session.set_gate(SetKeyGate(open=True), 100.0)
    session.sticks.set_reports_releases()
    session.press(FORWARD, session.blocked_reason(100.1), 100.1)
    session.renew_lease(104.6)
    assert session.sticks.held_keys(104.6) == ()
    assert session.blocked_reason(104.6) == "screen was frozen"
    lapses = [session.expire_lease(104.6) for _ in range(3)]
    assert lapses == [Lapse("display not responding for 4.6 s", drove=True, left=False), None, None]


def test_a_key_held_over_a_lapse_is_named_while_it_is_held() -> None:
    held = HeldKey(releases=True)
    held.now += 0.5
    for _ in range(200):
        held.step(REPEAT)
    assert held.ignored == "screen was frozen"
    held.do(DriveKeyUp(key="i"))
    for _ in range(80):
        held.step()
    assert held.ignored == "screen was frozen", "the eye takes a moment"
    held.do(FORWARD)
    assert held.ignored == ""


def test_a_key_that_is_held_from_before_arming_is_named() -> None:
    held = HeldKey(releases=True)
    held.station.operator.sticks.block(held.now)
    held.step(REPEAT)
    assert held.ignored == "it was held before"
    for _ in range(160):
        held.step()
    assert held.ignored == ""


def test_lapse_with_an_armed_rover_is_told_and_a_slow_start_not() -> None:
    starting = Station(["memory"], now=100.0)
    starting.handle_intent(RenewLease(), 100.0)
    starting.tick(100.6)
    assert starting.snapshot(100.6, 100.6).texts == ()
    held = HeldKey(releases=True)
    held.now += 0.5
    held.station.tick(held.now)
    lines = held.station.snapshot(held.now, held.now).texts
    assert lines[-1].text == "display not responding for 0.5 s: neutral, release the keys"


def lapse_lines(held: HeldKey) -> list[tuple[str, int]]:
    """Texts of lapses with their severities, after a screen that freezes for 0.5 s."""
    held.now += 0.5
    held.station.tick(held.now)
    lines = held.station.snapshot(held.now, held.now).texts
    return [(line.text, line.severity) for line in lines if line.text.startswith((LAPSE, "station stopped"))]


def test_a_lapse_with_a_key_down_is_critical_and_without_info() -> None:
    assert [severity for _, severity in lapse_lines(HeldKey(releases=True))] == [Severity.CRITICAL]
    idle = HeldKey(releases=True)
    idle.do(DriveKeyUp(key="i"))
    for _ in range(8):
        idle.step()
    assert lapse_lines(idle) == [("display not responding for 0.5 s: no key was down", Severity.INFO)]


def test_a_key_pressed_while_the_screen_is_frozen_is_critical() -> None:
    held = HeldKey(releases=True)
    held.do(DriveKeyUp(key="i"))
    for _ in range(8):
        held.step()
    held.now += 0.2
    held.do(FORWARD, DriveKeyUp(key="i"))
    assert [severity for _, severity in lapse_lines(held)] == [Severity.CRITICAL]


@pytest.mark.parametrize("reason", [QUITTING, f"{QUITTING}, disarming in 2 s", SUSPENDED])
def test_a_lapse_of_a_screen_that_is_left_is_not_told(reason: str) -> None:
    held = HeldKey(releases=True)
    held.do(SetKeyGate(open=False, reason=reason))
    assert lapse_lines(held) == []


def test_a_lapse_while_the_station_ends_is_not_told() -> None:
    held = HeldKey(releases=True)
    held.do(Quit(disarm=True))
    assert lapse_lines(held) == []


def test_a_lapse_over_a_vehicle_that_drives_itself_is_not_told() -> None:
    held = HeldKey(releases=True)
    flags = base_mode(Mode.AUTO, armed=True)
    beat = m.Heartbeat(VehicleType.GROUND_ROVER, Autopilot.GENERIC, flags, Mode.AUTO, SystemState.ACTIVE, 3)
    held.station.receive(Received(beat, 1, 1, 0, Peer(0, "vehicle"), introduced=True), held.now)
    assert lapse_lines(held) == []


def test_screen_frozen_during_rest_does_not_drive_a_later_arming() -> None:
    held = HeldKey(releases=True)
    session = held.station.operator
    session.set_resting(True, held.now)
    held.now += REST_LEASE_TIMEOUT - 0.1  # it has not renewed for so long, and may still do
    held.beat()
    session.set_resting(False, held.now)
    assert session.live
    held.now += LEASE_TIMEOUT + 0.01
    held.station.tick(held.now)
    assert not session.live
    assert held.throttle == 0.0
    assert not held.moves()


def test_repeated_ends_of_a_rest_do_not_keep_a_frozen_lease() -> None:
    session = OperatorSession(Style.HOLD, 0.6)
    session.renew_lease(100.0)
    for each in range(20):
        session.set_resting(True, 100.0 + each * 0.1)
        session.set_resting(False, 100.02 + each * 0.1)
    session.set_resting(True, 102.0)
    session.expire_lease(102.0)
    assert not session.live
