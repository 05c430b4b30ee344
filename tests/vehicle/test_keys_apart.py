"""Findings A4 and A5: any mix of keys and clocks leaves a drive key with a right clock able to drive within 8 s.

In virtual time, with a real rover behind a real channel. Nothing that was accepted once is accepted again, but what
docs/security.md names under S6.
"""

from __future__ import annotations

from collections.abc import Hashable

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from dialects import codec
from dialects import messages as m
from dialects.axes import Axes, build_manual_control
from dialects.enums import Command
from dialects.modes import Mode
from link.core import Outgoing
from link.protocol.channel import Channel
from link.protocol.signing_guard import SigningGuard, SigningPolicy
from link.signing.clock import to_stamp
from link.signing.keys import SigningKey
from link.signing.role import SigningRole
from link.signing.signature import link_and_stamp
from link.signing.signing import Signing, SigningMemory
from link.signing.streams import SignedStream
from tests.examples import examples
from tests.link.signing.signed import DAY, DRIVER, NOON, NOW, WATCHER, keep, signed
from tests.vehicle.bench import BEAT, MESSAGE_IDS
from vehicle.params import Params
from vehicle.rover import Rover

CYCLE = 0.02
WITHIN = 8.0
YEAR = 365 * 86_400.0
STORE_PERIOD = 30.0
VEHICLE = SigningPolicy(unsigned=SigningRole.WATCH, open_stops=True)
STATION = SigningPolicy(unsigned=None, greets_late=True, announces=True)
AHEAD, NEUTRAL = Axes(throttle=1.0), Axes()
DESK, ELSEWHERE = ("10.0.0.2", 14550), ("10.0.0.3", 14550)
"""The address of the driver, also of a bridge before it and of forged frames; that of others."""
ARM = m.CommandLong(1, 1, Command.COMPONENT_ARM_DISARM, 0, 1, 0, 0, 0, 0, 0, 0)
MANUAL = m.CommandLong(1, 1, Command.DO_SET_MODE, 0, 1, Mode.MANUAL, 0, 0, 0, 0, 0)


class DrivingStation:
    """A ground station of the drive key whose clock is right: it says who it is, arms and drives forward."""

    def __init__(self, now: float, address: Hashable = DESK, ids: tuple[int, int] = (255, 190)) -> None:
        self.address = address
        self.heard: list[m.Message] = []
        self._since = now
        guard = SigningGuard(keep(DRIVER, wall=NOON + now, now=now), STATION, 0)
        self.channel = Channel("udpout:vehicle", 0, system=ids[0], component=ids[1], target="vehicle", guard=guard)

    def frames(self, now: float, cycle: int) -> list[bytes]:
        messages: list[m.Message] = []
        if cycle % 50 == 0:
            self.channel.report(now=now)
            messages.append(BEAT)
        if cycle % 50 == 10:
            messages += [ARM, MANUAL]
        if cycle % 5 == 0:
            armed = any(isinstance(each, m.Heartbeat) and each.base_mode & 128 for each in self.heard[-80:])
            messages.append(build_manual_control(AHEAD if armed and cycle % 200 > 20 else NEUTRAL, 1))
        return [data for each in messages for data, _, _ in self.channel.send(Outgoing(each), now=now)]

    def receive(self, data: bytes, now: float) -> None:
        self.heard += [each.message for each in self.channel.receive(data, "vehicle", now)]


class Field:
    """A vehicle that may be restarted, its clock, and all frames that it was ever sent."""

    def __init__(self, wall: float) -> None:
        self.now = 100.0
        self.wall = wall - self.now
        """What the clock of the vehicle shows is this much more than `now`."""
        self.synchronized = False
        self.sent: list[tuple[bytes, Hashable]] = []
        self.accepted: list[tuple[float, bytes]] = []
        self.twice: list[bytes] = []
        self.excused: set[bytes] = set()
        """What may be accepted once more: S6."""
        self._stored = SigningMemory()
        self._stored_at = self.now
        self._cycle = 0
        self._frames = 0
        self.station: DrivingStation | None = None
        self._start(SigningMemory())

    @property
    def turning(self) -> bool:
        return any(self.rover.outputs.throttles)

    def set_clock(self, wall: float, *, synchronized: bool) -> None:
        self.wall, self.synchronized = wall - self.now, synchronized
        self._update()

    def restart(self, wall: float, *, synchronized: bool, crash: bool) -> None:
        if crash:
            self.excused |= {data for at, data in self.accepted if at >= self._stored_at}
            memory = self._stored
        else:
            memory = self.signing.memory(self.now, ended=True)
        self.now += 3.0
        self.wall, self.synchronized = wall - self.now, synchronized
        self._start(memory)

    def put(self, data: bytes, address: Hashable) -> None:
        """Let a datagram of one frame arrive."""
        for received in self.channel.receive(data, address, self.now):
            if received.signed:
                self._note(data)
            self.rover.receive(received, self.now)
        for peer in self.channel.pop_untimely():
            self.rover.tell_time(peer, self.now)
        self._flush()

    def send(self, message: m.Message, key: SigningKey, fast: float, address: Hashable, ids: tuple[int, int]) -> None:
        """Send with a key whose clock is so many s fast."""
        self._frames += 1
        stamp = max(0, to_stamp(NOON + self.now + fast)) + self._frames
        data = signed(message, key, stamp, link_id=self._frames % 4, sequence=self._frames & 0xFF, ids=ids)
        self.sent.append((data, address))
        self.put(data, address)

    def replay(self) -> None:
        """Send all frames again, from the address of the driver and from another one."""
        for data, _ in list(self.sent):
            self.put(data, DESK)
            self.put(data, ELSEWHERE)

    def run(self, seconds: float) -> None:
        for _ in range(round(seconds / CYCLE)):
            self._step()

    def drive(self) -> float:
        """Let a station with a right clock drive; return after how many s the wheels turn."""
        start, self.station = self.now, DrivingStation(self.now)
        while not self.turning:
            assert self.now - start < WITHIN, "the drive key is locked out"
            self._step()
        return self.now - start

    def _start(self, memory: SigningMemory) -> None:
        self.signing = Signing(keep(DRIVER, WATCHER).ring, wall=self.wall + self.now, now=self.now, memory=memory,
                               synchronized=self.synchronized)  # fmt: skip
        self._excuse_healed()
        self.rover = Rover(Params({}), now=self.now)
        guard = SigningGuard(self.signing, VEHICLE, 0)
        self.channel = Channel("udpin:0.0.0.0:14550", 0, system=1, component=1, wanted=MESSAGE_IDS, guard=guard)
        self._store()

    def _update(self) -> None:
        self.signing.update(self.wall + self.now, self.now, synchronized=self.synchronized)
        self._excuse_healed()

    def _excuse_healed(self) -> None:
        """Once the right time is known, frames of less than a day ahead may come again if their key went far ahead."""
        if self.signing.clock.synchronized and self.signing.verifier.streams.spans:
            right = self.signing.clock.stamp(self.now)
            self.excused |= {data for _, data in self.accepted if right < link_and_stamp(data)[1] <= right + DAY}

    def _store(self) -> None:
        self._stored, self._stored_at = self.signing.memory(self.now), self.now

    def _note(self, data: bytes) -> None:
        if any(data == each for _, each in self.accepted) and data not in self.excused:
            self.twice.append(data)
        self.accepted.append((self.now, data))

    def _step(self) -> None:
        self._cycle += 1
        self.now = round(self.now + CYCLE, 6)
        if self._cycle % 50 == 0:
            self._update()
            self.channel.expire_peers(self.now)
            self.channel.reserve(self.rover.reserved_ids)
            self.rover.observe([self.channel.report(now=self.now)], self.now)
            if self.now - self._stored_at >= STORE_PERIOD:
                self._store()
        if self.station is not None:
            for data in self.station.frames(self.now, self._cycle):
                self.sent.append((data, self.station.address))
                self.put(data, self.station.address)
        self.rover.tick(self.now)
        self._flush()

    def _flush(self) -> None:
        for outgoing in self.rover.messages_to_send():
            for data, address, _ in self.channel.send(outgoing, now=self.now):
                if self.station is not None and address == self.station.address:
                    self.station.receive(data, self.now)


# ---- the table of A4 and A5 ----


@pytest.mark.parametrize("fast", [30.0, 120.0, 3600.0, 30 * YEAR, 73 * YEAR])
@pytest.mark.parametrize("set_right", [False, True])
def test_another_key_with_any_clock_locks_no_drive_key_out(fast: float, set_right: bool) -> None:
    field = Field(wall=12.0)
    for _ in range(3):
        field.send(BEAT, WATCHER, fast, ELSEWHERE, (254, 190))
        field.run(1.0)
    if set_right:
        field.set_clock(NOON + field.now, synchronized=False)
    assert field.drive() < 3.0


@pytest.mark.parametrize("wall", [12.0, NOON])
@pytest.mark.parametrize("synchronized", [False, True])
def test_watch_key_behind_the_drivers_bridge_spoils_no_drive_key(wall: float, synchronized: bool) -> None:
    """40 years ahead, from the driver's address; then the vehicle restarts, and the driver comes from elsewhere."""
    field = Field(wall)
    field.set_clock(wall, synchronized=synchronized)
    for _ in range(5):
        field.send(BEAT, WATCHER, 40 * YEAR, DESK, (254, 190))
        field.run(1.0)
    assert field.drive() < 3.0
    field.run(2.0)
    newest = field.signing.memory(field.now).newest
    assert all(stamp < NOW + DAY for stream, stamp in newest.items() if stream.key == DRIVER.fingerprint)
    field.restart(wall + 60.0, synchronized=synchronized, crash=False)
    assert field.drive() < 3.0


@pytest.mark.parametrize("synchronized", [False, True])
def test_a_memory_that_was_poisoned_before_is_no_obstacle(synchronized: bool) -> None:
    """With the right time it heals; without, the station learns the time that is accepted, and says so."""
    field = Field(NOON + 100.0)
    poisoned = {stream._replace(link_id=lane): NOW + 40 * 365 * DAY for stream in _streams() for lane in range(4)}
    field._start(SigningMemory(NOW - DAY, poisoned, ended=True))
    field.set_clock(NOON + field.now, synchronized=synchronized)
    assert field.drive() < WITHIN
    newest = max(field.signing.memory(field.now).newest.values())
    assert (newest < NOW + DAY) is synchronized


def _streams() -> list[SignedStream]:
    signing = keep(DRIVER)
    signing.verifier.check(signed(), 255, 190, 0.0)
    return list(signing.memory(0.0).newest)


def test_a_stamp_a_day_ahead_is_refused_where_the_time_is_right() -> None:
    for fast, accepted in ((86_390.0, True), (86_410.0, False), (40 * YEAR, False)):
        field = Field(NOON + 100.0)
        field.set_clock(NOON + field.now, synchronized=True)
        field.send(BEAT, WATCHER, fast, ELSEWHERE, (254, 190))
        assert bool(field.accepted) is accepted


def test_a_clock_of_the_last_shutdown_refuses_nobody_ahead() -> None:
    """A computer without a battery for its clock begins where it was switched off: that looks like a set clock."""
    field = Field(NOON - 30 * 86_400.0)
    assert field.signing.clock.trusted
    assert field.drive() < 3.0


def test_where_time_is_right_nobody_is_told_one_of_years_ahead() -> None:
    """A station that followed it would be refused: the clock of the vehicle was set after it had met that key."""
    field = Field(NOON - 30 * 86_400.0)
    field.send(BEAT, DRIVER, 40 * YEAR, DESK, (255, 190))
    field.set_clock(NOON + field.now, synchronized=True)
    assert field.drive() < WITHIN


# ---- answers ----


def answers(field: Field) -> list[tuple[Hashable, bytes]]:
    field.rover.messages_to_send()
    found: list[tuple[Hashable, bytes]] = []
    for peer in field.channel.pop_untimely():
        field.rover.tell_time(peer, field.now)
    for outgoing in field.rover.messages_to_send():
        found += [(address, data) for data, address, _ in field.channel.send(outgoing, now=field.now)]
    return found


def test_genuine_frame_that_is_too_old_is_answered_once_a_second() -> None:
    field, count = Field(NOON + 100.0), 0
    old = [signed(BEAT, stamp=NOW - DAY + n, ids=(255, 190), link_id=3) for n in range(100)]
    for data in old:
        assert field.channel.receive(data, DESK, field.now) == []
        for address, answer in answers(field):
            count += 1
            assert address == DESK
            assert len(answer) <= len(data), "no reflection"
            assert link_and_stamp(answer)[1] >= field.signing.clock.stamp(field.now)
            assert keep(DRIVER, wall=NOON - 86_400).verifier.check(answer, 1, 1, 0.0)
        field.now += 0.05
    assert 5 <= count <= 6


@pytest.mark.parametrize("kind", ["forged", "unsigned", "copy of a second link"])
def test_what_is_not_genuine_or_is_a_copy_is_not_answered(kind: str) -> None:
    field = Field(NOON + 100.0)
    field.send(BEAT, DRIVER, 0.0, DESK, (255, 190))
    stranger = SigningKey("x", SigningRole.SET_UP, bytes(range(32)))
    data = {
        "forged": signed(BEAT, stranger, NOW - DAY),
        "unsigned": codec.frame(m.Heartbeat.id, codec.encode_payload(BEAT), 9, 250, 190),
        "copy of a second link": field.sent[0][0],
    }[kind]
    field.channel.receive(data, DESK, field.now)
    assert field.channel.pop_untimely() == []


def test_answers_go_to_32_addresses_a_second_at_most() -> None:
    field = Field(NOON + 100.0)
    for host in range(100):
        field.channel.receive(signed(BEAT, stamp=NOW - DAY), (f"10.7.0.{host}", 1), field.now)
    assert len(answers(field)) == 32


def test_a_station_reports_a_clock_a_day_ahead_before_it_follows() -> None:
    station = DrivingStation(0.0)
    ahead = to_stamp(NOON + 40 * YEAR)
    station.receive(signed(BEAT, stamp=ahead, ids=(1, 1)), 0.0)
    (data,) = [each for each, _, _ in station.channel.send(Outgoing(BEAT), now=0.0)]
    assert link_and_stamp(data)[1] < NOW + DAY
    guard = station.channel.report(now=0.0).guard
    assert guard is not None
    assert guard.ahead == {1: pytest.approx(40 * YEAR)}
    (data,) = [each for each, _, _ in station.channel.send(Outgoing(BEAT), now=0.0)]
    assert link_and_stamp(data)[1] >= ahead


# ---- any mix ----

CLOCKS = [-NOON, -30 * 86_400.0, -120.0, 0.0, 30.0, 120.0, 3600.0, 40 * YEAR, 73 * YEAR]
"""s by which the clock of a sender is fast: 1970, a month behind, ..., years ahead."""
OWN_CLOCKS = [(12.0, False), (NOON, True), (NOON, False), (NOON - 30 * 86_400.0, False)]
"""What the vehicle's clock shows at NOON, and whether the system calls it right."""
EVENTS = st.one_of(
    st.tuples(
        st.just("send"),
        st.sampled_from([WATCHER, DRIVER]),
        st.sampled_from(CLOCKS),
        st.sampled_from([DESK, ELSEWHERE]),
        st.sampled_from([(254, 190), (255, 190)]),
        st.integers(1, 5),
    ),
    st.tuples(st.just("restart"), st.sampled_from(OWN_CLOCKS), st.booleans()),
    st.tuples(st.just("set"), st.booleans()),
    st.tuples(st.just("wait"), st.sampled_from([0.5, 5.0, 40.0])),
    st.tuples(st.just("drive")),
    st.tuples(st.just("replay")),
)


@settings(max_examples=examples(60), deadline=None, suppress_health_check=list(HealthCheck))
@given(st.sampled_from(OWN_CLOCKS), st.lists(EVENTS, max_size=8))
def test_any_mix_of_keys_clocks_and_restarts(first: tuple[float, bool], events: list[tuple[object, ...]]) -> None:
    field = Field(first[0])
    field.set_clock(first[0], synchronized=first[1])
    for event in events:
        play(field, event)
    field.station = None
    field.run(0.5)
    field.drive()
    field.station = None
    field.run(1.5)
    assert not field.turning, "its silence stops it"
    field.replay()
    field.run(0.5)
    assert field.twice == []
    assert not field.turning or field.excused, "demands without a session may come again after a crash"


def play(field: Field, event: tuple[object, ...]) -> None:
    match event:
        case ("send", SigningKey() as key, float() as fast, tuple() as address, (int() as system, int() as unit),
              int() as count):  # fmt: skip
            for _ in range(count):
                field.send(BEAT, key, fast, address, (system, unit))
                field.run(0.1)
        case ("restart", (float() as wall, bool() as synchronized), bool() as crash):
            field.restart(wall + field.now, synchronized=synchronized, crash=crash)
        case ("set", bool() as synchronized):
            field.set_clock(NOON + field.now, synchronized=synchronized)
        case ("wait", float() as seconds):
            field.run(seconds)
        case ("drive",):
            field.drive()
            field.station = None
        case _:
            field.replay()
