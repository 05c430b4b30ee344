"""Operator sessions: demands that prove their age, beside copies, late links and duplicates (the same system id)."""

from __future__ import annotations

import heapq
import itertools
import random

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from dialects import messages as m
from dialects.axes import Axes
from dialects.enums import OperatorFlag
from dialects.modes import Mode
from tests.examples import examples
from tests.vehicle.bench import AHEAD, CYCLE, DRIVER, NEUTRAL, Bench, said
from tests.vehicle.field import Field
from vehicle.drive.driver import SUCCESSION_TIME
from vehicle.drive.operator_session import PROOF_VALID, SENDERS_MAX

BOOT = 100.0
FAST, SLOW = "fast link", "slow link"


class Station:
    """A ground station with sessions: it sends proofs with axes, and the MANUAL_CONTROL that follows them."""

    def __init__(self, bench: Bench, session: int = 7, address: str = f"gcs {DRIVER}") -> None:
        self.bench = bench
        self.session = session
        self.address = address
        self.clock = 1000
        self.built: dict[int, tuple[float, Axes | None]] = {}
        """Clock of each proof -> when it was built, and its axes."""

    def build(self, axes: Axes | None, *, echo_age: float = 0.02, flags: int = 16) -> m.RoverOperatorPresence:
        self.clock += 1
        self.built[self.clock] = (self.bench.now, axes)
        echo = round((self.bench.now - BOOT - echo_age) * 1000)
        x, r = (round(axes.throttle * 1000), round(axes.steering * 1000)) if axes else (m.INVALID_AXIS, m.INVALID_AXIS)
        none = m.INVALID_AXIS
        return m.RoverOperatorPresence(1, 1, self.clock, max(0, echo), self.session, 1, 0, flags, x, none, none, r)

    def send(self, axes: Axes | None, *, echo_age: float = 0.02, manual: bool = True) -> m.RoverOperatorPresence:
        proof = self.build(axes, echo_age=echo_age)
        self.bench.say(proof, address=self.address)
        if axes and manual:
            self.manual(axes)
        return proof

    def manual(self, axes: Axes) -> None:
        message = m.ManualControl(1, round(axes.throttle * 1000), 0, 0, round(axes.steering * 1000), 0)
        self.bench.say(message, address=self.address)

    def hold(self, seconds: float, axes: Axes, **how: float) -> None:
        for _ in range(round(seconds / 0.05)):
            self.send(axes, **how)  # type: ignore[arg-type]
            self.bench.wait(0.05)

    def take_off(self) -> None:
        """Prove the session, arm, show neutral and drive: the danger that the tests begin with."""
        self.send(None)
        self.bench.arm()
        self.hold(0.2, NEUTRAL)
        self.hold(1.0, AHEAD)
        assert self.bench.turning


def going() -> tuple[Bench, Station]:
    bench = Bench()
    bench.wait(2.0)
    station = Station(bench)
    station.take_off()
    return bench, station


def guided() -> Field:
    """A rover that drives to a target in GUIDED, with its driver's stick at rest."""
    field = Field()
    station = Station(field)
    station.bench.wait(3.0)
    station.send(None)
    field.begin(Mode.GUIDED)
    field.goto(100.0, 0.0)
    for _ in range(40):
        station.send(NEUTRAL)
        field.wait(0.05)
    assert field.turning
    return field


# ---- a session drives by its proofs, and by nothing else ----


def test_a_session_drives_by_its_proofs_alone() -> None:
    bench = Bench()
    bench.wait(2.0)
    station = Station(bench)
    station.send(None)
    bench.arm()
    for axes, seconds in ((NEUTRAL, 0.2), (AHEAD, 1.0)):
        for _ in range(round(seconds / 0.05)):
            station.send(axes, manual=False)
            bench.wait(0.05)
    assert bench.throttles[0] == pytest.approx(1.0, abs=0.05)


def test_manual_control_with_the_drivers_system_id_moves_nothing() -> None:
    bench, station = going()
    station.hold(1.0, NEUTRAL)
    assert not bench.turning
    for _ in range(40):  # a twin's stick, or copies of old frames, beside fresh neutral proofs
        station.send(NEUTRAL, manual=False)
        station.manual(AHEAD)
        bench.say(m.RcChannelsOverride(1, 1, 1500, 0, 1900, 0, 0, 0, 0, 0))
        bench.wait(0.05)
        assert not bench.turning


def test_a_twins_neutral_does_not_open_the_interlock() -> None:
    bench = Bench()
    bench.wait(2.0)
    station = Station(bench)
    station.send(None)
    bench.arm()
    twin = Station(bench, session=8, address="twin")
    for _ in range(40):
        station.send(AHEAD)
        twin.send(NEUTRAL)
        bench.wait(0.05)
        assert not bench.turning
    station.hold(0.2, NEUTRAL)
    station.hold(1.0, AHEAD)
    assert bench.turning


def test_a_ground_station_without_sessions_drives_as_before() -> None:
    bench = Bench()
    bench.drive()
    bench.wait(1.0, NEUTRAL)
    assert not bench.turning


def test_a_proof_after_arming_names_no_session() -> None:
    """It could be a twin's: the ground station that has armed drives by MANUAL_CONTROL until it takes control again."""
    bench = Bench()
    bench.wait(2.0)
    bench.drive()
    twin = Station(bench, session=8, address="twin")
    twin.hold(0.5, NEUTRAL, echo_age=0.02)
    bench.wait(0.2, NEUTRAL)
    bench.wait(1.0, AHEAD)
    assert bench.turning


def test_armed_over_a_late_link_its_demands_have_the_same_bound() -> None:
    """No proof was good when it armed, so that it drives without a session once the link is better."""
    bench = Bench()
    bench.wait(2.0)
    station = Station(bench)
    station.hold(1.0, NEUTRAL, echo_age=0.6)
    bench.arm()
    station.hold(0.2, NEUTRAL)
    station.hold(1.0, AHEAD, echo_age=0.3)
    assert bench.turning
    full = bench.throttles[0]
    bench.wait(0.05)
    assert bench.throttles[0] == full, "0.40 s after what it had seen"
    bench.wait(0.07)
    assert bench.throttles[0] < full, "0.47 s after what it had seen"


def test_armed_over_a_late_link_it_drives_only_after_a_proof() -> None:
    """MANUAL_CONTROL alone, its proofs lost, says nothing of its age."""
    bench = Bench()
    bench.wait(2.0)
    station = Station(bench)
    station.hold(1.0, NEUTRAL, echo_age=0.6)
    bench.arm()
    for axes in (NEUTRAL, AHEAD):
        for _ in range(10):
            station.manual(axes)
            bench.wait(0.05)
    assert not bench.turning
    station.hold(0.2, NEUTRAL)
    station.hold(1.0, AHEAD)
    assert bench.turning


def test_of_many_senders_of_proofs_the_newest_are_remembered() -> None:
    bench = Bench()
    bench.wait(2.0)
    for number in range(SENDERS_MAX + 3):
        Station(bench, session=number, address=f"gcs {number}").send(None)
    assert len(bench.rover._control.ownership._proof_at) == SENDERS_MAX


# ---- old proofs ----


def test_proofs_of_a_slow_second_link_neither_drive_nor_stop() -> None:
    bench, station = going()
    late: list[tuple[float, m.RoverOperatorPresence]] = []
    for step in range(160):
        axes = AHEAD if step < 40 else NEUTRAL  # drives 2 s, lets go, and sends neutral all the while
        late.append((bench.now + 3.0, station.send(axes, manual=False)))
        while late and late[0][0] <= bench.now:
            bench.say(late.pop(0)[1], address=SLOW)
        bench.wait(0.05)
        if step >= 40 + 12:
            assert not bench.turning, step
    station.hold(0.2, NEUTRAL)
    station.hold(0.5, AHEAD)
    assert bench.turning  # the slow link has stopped nothing


def test_a_cut_fast_link_leaves_a_slow_one_that_drives_nothing() -> None:
    bench, station = going()
    for step in range(60):
        bench.say(station.build(AHEAD, echo_age=3.0), address=SLOW)
        bench.wait(0.05)
        if step * 0.05 > 0.45 + 0.5:
            assert not bench.turning


def test_an_old_proof_that_is_the_newest_still_stops() -> None:
    bench, station = going()
    bench.say(station.build(NEUTRAL, echo_age=2.0), address=SLOW)
    bench.wait(0.1)
    assert bench.throttles[0] < 0.95
    station.hold(0.6, AHEAD)
    assert bench.turning  # a stop of any age, but no proof of a stick at rest: the interlock was open all the while


def test_a_demand_ends_when_its_proof_is_as_old_as_opr_echo_max() -> None:
    bench, station = going()
    station.send(AHEAD, echo_age=0.3)  # 0.15 s are left of OPR_ECHO_MAX
    full = bench.throttles[0]
    bench.wait(0.12)
    assert bench.throttles[0] == full
    bench.wait(0.08)
    assert bench.throttles[0] < full


@pytest.mark.parametrize("echo_age", [10_000.0, 0.46, 5.0])
def test_a_proof_without_a_fresh_echo_proves_nothing(echo_age: float) -> None:
    bench = Bench()
    bench.wait(2.0)
    station = Station(bench)
    station.send(None, echo_age=echo_age)
    bench.arm()
    for _ in range(40):
        station.send(NEUTRAL, echo_age=echo_age, manual=False)
        station.send(AHEAD, echo_age=echo_age, manual=False)
        bench.wait(0.05)
        assert not bench.turning


def test_copies_of_a_proof_move_nothing() -> None:
    bench, station = going()
    copies = [station.send(AHEAD) for _ in range(5)]
    station.hold(1.0, NEUTRAL)
    assert not bench.turning
    for copy in itertools.chain(copies, copies):
        bench.say(copy, address="elsewhere")
        bench.wait(0.05)
        station.send(NEUTRAL)
        assert not bench.turning


# ---- who is missed ----


def test_heartbeats_of_a_twin_do_not_keep_the_failsafe_quiet() -> None:
    field = guided()
    for _ in range(70):  # the driver is killed; another program with its system id goes on
        field.heartbeat()
        field.wait(0.1)
    assert not field.turning
    assert field.mode is Mode.HOLD


def test_the_driver_is_told_of_a_twin_once() -> None:
    bench, station = going()
    twin = Station(bench, session=8, address="twin")
    for _ in range(60):
        station.send(AHEAD)
        twin.send(NEUTRAL)
        bench.wait(0.05)
    assert bench.turning
    assert len([text for text in bench.texts if "Another program uses your ids 255/190" in text]) == 1


# ---- succession ----


def test_a_restarted_ground_station_drives_again_within_a_second() -> None:
    bench, _ = going()
    restarted = Station(bench, session=9, address="new port")
    restarted.hold(SUCCESSION_TIME - 0.1, NEUTRAL)
    assert not said(bench, "drives from another program now")
    restarted.hold(0.3, NEUTRAL)
    assert said(bench, "drives from another program now")
    assert not bench.turning
    restarted.hold(0.2, AHEAD)
    assert bench.turning


def test_a_successor_shows_neutral_first() -> None:
    bench, _ = going()
    bench.wait(2 * SUCCESSION_TIME)
    assert not bench.turning
    successor = Station(bench, session=9)
    successor.hold(1.0, AHEAD)
    assert not bench.turning


def test_an_autonomous_mode_does_not_outlive_a_succession() -> None:
    field = guided()
    field.wait(SUCCESSION_TIME + 0.1)
    Station(field, session=9).send(NEUTRAL)
    field.wait(0.1)
    assert field.mode is Mode.HOLD


def test_a_ground_station_without_sessions_follows_a_lost_one() -> None:
    bench, _ = going()
    bench.wait(4.0, AHEAD)
    assert not bench.turning
    bench.wait(2.0, NEUTRAL)
    bench.set_mode(Mode.MANUAL)
    bench.wait(0.2, NEUTRAL)
    bench.wait(1.0, AHEAD)
    assert bench.turning


def test_the_session_is_that_of_the_sender_who_took_control() -> None:
    """Another program with the same system id proves itself last: it is not the one that has armed."""
    bench = Bench()
    bench.wait(2.0)
    station, twin = Station(bench), Station(bench, session=8, address="twin")
    station.send(None)
    twin.send(None)
    bench.arm()
    station.hold(0.2, NEUTRAL)
    for _ in range(20):
        station.send(NEUTRAL)
        twin.send(AHEAD)
        bench.wait(0.05)
        assert not bench.turning
    station.hold(1.0, AHEAD)
    assert bench.turning


def test_a_proof_is_forgotten_after_a_second() -> None:
    bench = Bench()
    bench.wait(2.0)
    station = Station(bench)
    station.send(None)
    bench.wait(PROOF_VALID + 0.1)
    bench.arm()
    bench.wait(0.2, NEUTRAL)
    bench.wait(1.0, AHEAD)
    assert bench.turning  # by MANUAL_CONTROL: no session is in control


# ---- any mix ----


@settings(max_examples=examples(25))
@given(st.integers(0, 2**32), st.floats(0.0, 0.4), st.floats(0.0, 3.0), st.booleans())
def test_no_demand_older_than_opr_echo_max_is_in_use(seed: int, loss: float, delay: float, twin_moves: bool) -> None:
    """Two links with any delay and loss, copies, and a twin: what moves the rover was sent in the last 0.45 s."""
    bench = Bench()
    bench.wait(2.0)
    chance = random.Random(seed)
    station, twin = Station(bench), Station(bench, session=8, address="twin")
    station.take_off()
    waiting: list[tuple[float, int, m.RoverOperatorPresence]] = []
    for number in range(200):
        proof = station.build(chance.choice((AHEAD, NEUTRAL)), echo_age=0.0)
        lags = (chance.uniform(0.0, 0.1), delay + chance.uniform(0.0, 0.3), chance.uniform(0.0, 5.0))
        for lag in (lag for lag in lags if chance.random() >= loss):
            heapq.heappush(waiting, (bench.now + lag, 3 * number + lags.index(lag), proof))
        while waiting and waiting[0][0] <= bench.now:
            bench.say(heapq.heappop(waiting)[2], address=chance.choice((FAST, SLOW, "copy")))
        if chance.random() < 0.3:
            twin.send(AHEAD if twin_moves else NEUTRAL)
        bench.wait(CYCLE)
        check_demand(bench, station)


def check_demand(bench: Bench, station: Station) -> None:
    """A demand for motion that counts was built for it, and less than OPR_ECHO_MAX ago."""
    control = bench.rover._control
    if (
        control.ownership.session is None
        or control.ownership.session.id != station.session
        or not control.requests_motion()
    ):
        return
    assert control.ownership.session.clock is not None
    at, axes = station.built[control.ownership.session.clock]
    assert axes is AHEAD
    if not control.is_demand_stale(bench.now):
        assert bench.now - at <= 0.45 + CYCLE


def test_flags_without_axes_are_an_older_ground_stations() -> None:
    bench = Bench()
    bench.wait(2.0)
    station = Station(bench)
    bench.say(station.build(None, flags=int(OperatorFlag.DEADMAN)))
    bench.arm()
    bench.wait(0.2, NEUTRAL)
    bench.wait(1.0, AHEAD)
    assert bench.turning
