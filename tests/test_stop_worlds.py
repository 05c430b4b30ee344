"""A signed, crowded rover with any clock, over a modem: a newly started `estop` stops it within 1 s, in any world.

Another station drives it. Strangers hold all places; the clock of the rover is at 1970, right, fast or years ahead; the
operator has the rover's key, another one or none; frames get late and lost on the way.
"""

from __future__ import annotations

import random
from collections import Counter
from collections.abc import Hashable

import msgspec
import pytest

from dialects import messages as m
from dialects.axes import Axes, build_manual_control
from dialects.enums import Command
from groundstation.station.driving.stops.emergency import EmergencyLock
from groundstation.vehicles.demand.blind_stop import BlindStop
from groundstation.vehicles.demand.repeated_stop import StopTimes
from groundstation.vehicles.demand.stop_commands import StopKind
from groundstation.verbs.control.stop_jobs import EmergencyJob
from link.protocol.channel import Channel
from link.protocol.signing_guard import SigningGuard, SigningPolicy
from link.signing.clock import to_stamp
from link.signing.keys import SigningKey
from link.signing.role import SigningRole
from link.transport.memory import LossyPipe
from tests.examples import examples
from tests.fakes.lone_verb import LoneVerb
from tests.link.signing.signed import DRIVER as OWNER
from tests.link.signing.signed import NOON, SIGNED_ONLY, STRANGER, WATCHER, keep, signed
from tests.vehicle.bench import AHEAD, BEAT, CYCLE, DRIVER, NEUTRAL
from tests.vehicle.test_stops_in_a_crowd import DRIVER_ADDRESS, NEW_STATION, STRANGERS, CrowdedLink
from vehicle.safety.states import SafetyState

WORLDS = examples(500)
"""125 in CI, of all kinds, too."""
STOPPED_WITHIN = 1.0
YEAR = 365 * 86_400.0
VERB = (254, 190)


class WorldFacts(msgspec.Struct, frozen=True):
    """What one world is like."""

    clock: float
    """Unix time of the rover, s."""
    strangers: SigningKey | None
    """The key with which they sign."""
    key: SigningKey | None
    """The operator's."""
    vehicle: int | None
    """That of --vehicle."""
    loss: float
    delay: float
    seed: int

    @classmethod
    def roll(cls, seed: int) -> WorldFacts:
        """Return a random world."""
        dice = random.Random(seed)
        return cls(
            clock=dice.choice((0.0, NOON, NOON + 120, NOON + 30 * YEAR, dice.uniform(0, NOON))),
            strangers=dice.choice((None, WATCHER)),
            key=dice.choice((OWNER, STRANGER, None)),
            vehicle=dice.choice((None, 1)),
            loss=dice.uniform(0.0, 0.3),
            delay=dice.uniform(0.0, 0.2),
            seed=seed,
        )


class StopWorld(CrowdedLink):
    """A rover that is driven by a station with its key, and an `estop` that is started beside it."""

    def __init__(self, facts: WorldFacts) -> None:
        self.up = LossyPipe[bytes](delay=facts.delay, jitter=facts.delay / 2, loss=facts.loss, seed=facts.seed)
        self.down = LossyPipe[bytes](delay=facts.delay, jitter=facts.delay / 2, loss=facts.loss, seed=facts.seed + 1)
        super().__init__(keep(OWNER, WATCHER, wall=facts.clock, now=100.0), facts.strangers)
        assert self.channel.guard is not None
        self.channel.guard = SigningGuard(
            keep(OWNER, WATCHER, wall=facts.clock, now=100.0), SigningPolicy(SigningRole.WATCH, open_stops=True), 0
        )
        self.facts = facts
        self.lone = LoneVerb(VERB, facts.vehicle, 1)
        self.core = self.lone.core
        guard = None
        if facts.key is not None:
            guard = SigningGuard(keep(facts.key, wall=NOON + 100.0, now=100.0), SIGNED_ONLY, 0)
        self.verb = Channel("modem", 0, system=VERB[0], component=VERB[1], target="rover", guard=guard)

    def send(self, message: m.Message, address: Hashable, system: int, key: SigningKey | None = None) -> None:
        """Send as a station that follows the clock of the rover, as it does once it has heard it."""
        if key is None:
            super().send(message, address, system)
            return
        self._frames += 1
        stamp = to_stamp(max(NOON, self.facts.clock) + self.now) + self._frames
        data = signed(message, key, stamp, sequence=self._number(address), ids=(system, 190))
        for received in self.channel.receive(data, address, self.now):
            self.rover.receive(received, self.now)
        self._flush()

    def get_going(self) -> None:
        """Let strangers take the places and another station drive."""
        self.steer(CYCLE, NEUTRAL)
        self.send(m.CommandLong(1, 1, Command.COMPONENT_ARM_DISARM, 0, 1, 0, 0, 0, 0, 0, 0), *self.driver)
        for number in range(STRANGERS):
            self.send(BEAT, (f"10.1.0.{number}", 20000), 100 + number, self.facts.strangers)
        self.steer(0.3, NEUTRAL)
        self.steer(0.6, AHEAD)
        assert any(self.rover.outputs.throttles), self.facts

    def _number(self, address: Hashable) -> int:
        sequence = self._sequences[address] = (self._sequences.get(address, -1) + 1) & 0xFF
        return sequence

    @property
    def driver(self) -> tuple[tuple[str, int], int, SigningKey]:
        return DRIVER_ADDRESS, DRIVER, OWNER

    def control(self, demand: m.Message) -> None:
        self.send(BEAT, *self.driver)
        self.send(demand, *self.driver)

    def steer(self, seconds: float, axes: Axes) -> None:
        for _ in range(round(seconds / CYCLE)):
            self.now += CYCLE
            self.control(build_manual_control(axes, 1))
            self.channel.reserve(self.rover.reserved_ids)
            self.rover.tick(self.now)
            self._flush()

    def press_stop(self) -> float:
        """Start the verb; return after how many s the wheels stand."""
        began, job = self.now, None
        blind = BlindStop(StopKind.EMERGENCY, self.facts.vehicle or 0, VERB, began)
        while any(self.rover.outputs.throttles) or self.rover.state is SafetyState.ARMED:
            assert self.now - began <= STOPPED_WITHIN, self.facts
            self.lone.tick(self.now)
            if self.core.chosen is None:
                self.core.send(*blind.tick(self.now))
            elif job is None:
                state = self.core.chosen.state
                job = EmergencyJob(1, EmergencyLock(state, self.now), StopTimes(self.now, began + 1.3, began + 30))
                self.core.chosen.services.book.begin(1, "emergency stop")
                self.core.chosen.start(job, self.now)
            self.exchange()
            self.steer(CYCLE, AHEAD)
        return self.now - began

    def exchange(self) -> None:
        for outgoing in self.lone.messages_to_send():
            for data, _, _ in self.verb.send(outgoing, now=self.now):
                self.up.send(data, self.now)
        for data in self.up.receive(self.now):
            for received in self.channel.receive(data, NEW_STATION, self.now):
                self.rover.receive(received, self.now)
        self._flush()
        for data in self.down.receive(self.now):
            for received in self.verb.receive(data, "rover", self.now):
                self.lone.receive(received, self.now)

    def _flush(self) -> None:
        for outgoing in self.rover.messages_to_send():
            for data, address, _ in self.channel.send(outgoing, now=self.now):
                if address == NEW_STATION:
                    self.down.send(data, self.now)


def stop_in(seed: int) -> float:
    world = StopWorld(WorldFacts.roll(seed))
    world.get_going()
    return world.press_stop()


@pytest.mark.parametrize("block", [pytest.param(each, marks=[pytest.mark.slow] if each else []) for each in range(10)])
def test_a_new_estop_stops_the_rover_within_a_second(block: int) -> None:
    size = WORLDS // 10
    for seed in range(block * size, (block + 1) * size):
        assert stop_in(seed) <= STOPPED_WITHIN


def test_the_worlds_are_of_all_kinds() -> None:
    worlds = [WorldFacts.roll(seed) for seed in range(WORLDS)]
    kinds = Counter((each.key, each.strangers, each.clock < NOON, each.clock > NOON) for each in worlds)
    assert len(kinds) == 18
    assert max(each.loss for each in worlds) > 0.29


def test_without_a_stop_the_rover_drives_on() -> None:
    world = StopWorld(WorldFacts.roll(1))
    world.get_going()
    world.steer(3.0, AHEAD)
    assert any(world.rover.outputs.throttles)
