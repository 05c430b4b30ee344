"""A monkey at keys, screen, modes, processes and link of a copter: nothing but a held key sends it down.

z below 400 is sent only while the operator holds the key to descend, in a mode that holds altitude, and never below the
least z. Nothing disarms it in the air, and in modes that hold altitude it never falls.
"""

from __future__ import annotations

import math
from typing import Any

import pytest
from hypothesis import Phase, given, settings
from hypothesis import strategies as st

from dialects import messages as m
from dialects.axes import HOVER, LOWEST_THROTTLE
from dialects.enums import Command
from groundstation.intents.driving import DriveKeyDown, DriveKeyUp, DrivePad, EmergencyStop, SetStyle, Stop
from groundstation.intents.session import Quit, SetKeyGate
from groundstation.intents.union import AnyIntent
from groundstation.intents.vehicle import Disarm, ReleaseControl, SetMode, TakeOff
from tests.examples import examples
from tests.fakes.flying import THRUST, FlyingVehicle
from tests.fakes.multicopters import ArduCopter, Px4Quad
from tests.flight import hovering_cockpit
from tests.world import World

NO_DESCENT = 400
LEASE = 0.3
SLACK = 0.06
"""s: a step of time and a tick."""
KEYS = {
    "i": DriveKeyDown(key="i", throttle=1, steering=0),
    "comma": DriveKeyDown(key="comma", throttle=-1, steering=0),
    "j": DriveKeyDown(key="j", throttle=0, steering=-1),
    "o": DriveKeyDown(key="o", throttle=0, steering=0, side=1),
    "pageup": DriveKeyDown(key="pageup", throttle=0, steering=0, climb=1),
    "pagedown": DriveKeyDown(key="pagedown", throttle=0, steering=0, climb=-1),
}
DOWN = "pagedown"


class FlightMonkey:
    """A hovering copter with an operator; checks what is sent at each step of time."""

    def __init__(self, copter: FlyingVehicle) -> None:
        self.copter = copter
        self.cockpit = hovering_cockpit(copter, 10.0)
        self.world: World = self.cockpit.world
        self.held: set[str] = set()
        self.down_at = self.pad_down_at = -math.inf
        self.lowered = 0
        """Demands that sent it down."""
        self.thrust = False
        """Somebody has chosen a mode without altitude, in which it may fall."""
        self._seen = len(self.world.near.sent)

    # ---- what the monkey does ----

    def press(self, key: str) -> None:
        self.held.add(key)
        self._do(KEYS[key])

    def release(self, key: str) -> None:
        self.held.discard(key)
        self._do(DriveKeyUp(key=key))

    def pad(self, climb: float) -> None:
        self.pad_down_at = self.world.now if climb < 0 else self.pad_down_at
        self._do(DrivePad(throttle=1.0, steering=0.0, side=-1.0, climb=climb, read_at=self.world.now))

    def tell(self, intent: AnyIntent) -> None:
        self._do(intent)

    def screen(self, lives: bool) -> None:
        self.cockpit.leasing = lives

    def station(self, runs: bool) -> None:
        self.world.near.frozen = not runs

    def crash(self, _: bool) -> None:
        self.cockpit.core.activate(self.world.now)

    def link(self, works: bool) -> None:
        self.world.cut(not works)

    def delay(self, seconds: float) -> None:
        self.world.up.delay = self.world.down.delay = seconds

    def loss(self, share: float) -> None:
        self.world.up.loss = self.world.down.loss = share

    def pilot(self, mode: str) -> None:
        """Let its transmitter, a failsafe or another station change the mode."""
        name = _PX4_NAMES.get(mode, mode) if isinstance(self.copter, Px4Quad) else mode
        self.thrust |= name in THRUST
        self.copter.set_mode(name)

    # ---- what holds ----

    def run(self, seconds: float) -> None:
        for _ in range(round(seconds / 0.05)):
            if DOWN in self.held:
                self.down_at = self.world.now + 0.05
            self.cockpit.run(0.05)
            self._check()

    def _check(self) -> None:
        sent = self.world.near.sent
        for at, message in sent[self._seen :]:
            if isinstance(message, m.ManualControl):
                assert message.z >= LOWEST_THROTTLE
                if message.z < NO_DESCENT:
                    self.lowered += 1
                    assert at - max(self.down_at, self.pad_down_at) <= LEASE + SLACK
            elif isinstance(message, m.CommandLong) and message.command == Command.COMPONENT_ARM_DISARM:
                assert not message.param2, "forced"
        self._seen = len(sent)
        if not self.thrust:
            assert self.copter.hit_ground_at < 1.5
            assert self.copter.armed or not self.copter.flies

    def _do(self, intent: AnyIntent) -> None:
        if not self.world.near.frozen:
            self.cockpit.do(intent)


_PX4_NAMES = {"STABILIZE": "STABILIZED", "ALT_HOLD": "ALTCTL", "LOITER": "POSCTL", "RTL": "AUTO_RTL",
              "LAND": "AUTO_LAND", "BRAKE": "HOLD", "AUTO": "AUTO_MISSION"}  # fmt: skip
INTENTS: list[AnyIntent] = [
    Stop(), SetKeyGate(open=False, reason="x"), SetKeyGate(open=True), SetMode(mode="MANUAL"), SetMode(mode="HOLD"),
    SetMode(mode="LAND"), SetMode(mode="RTL"), ReleaseControl(), Disarm(), EmergencyStop(), SetStyle(style="latch"),
    SetStyle(style="hold"), TakeOff(held=1.0), Quit(disarm=True),
]  # fmt: skip
Step = tuple[Any, ...]
STEPS: st.SearchStrategy[Step] = st.one_of(
    st.tuples(st.just("press"), st.sampled_from(sorted(KEYS))),
    st.tuples(st.just("press"), st.just(DOWN)),  # most often, or there is nothing to see
    st.tuples(st.just("release"), st.sampled_from(sorted(KEYS))),
    st.tuples(st.just("pad"), st.sampled_from([-1.0, 0.0, 1.0])),
    st.tuples(st.just("tell"), st.sampled_from(INTENTS)),
    st.tuples(st.just("screen"), st.booleans()),
    st.tuples(st.just("station"), st.booleans()),
    st.tuples(st.just("link"), st.booleans()),
    st.tuples(st.just("delay"), st.sampled_from([0.0, 0.15, 0.4])),
    st.tuples(st.just("loss"), st.sampled_from([0.0, 0.2, 0.5])),
    st.tuples(st.just("pilot"), st.sampled_from(["STABILIZE", "ALT_HOLD", "LOITER", "RTL", "LAND", "BRAKE", "AUTO"])),
    st.tuples(st.just("crash"), st.just(True)),
)
PAUSES = st.sampled_from([0.05, 0.3, 0.6, 1.5, 4.0])
"""s between two steps."""


def test_the_monkey_sees_a_descent_by_key_and_its_end() -> None:
    monkey = FlightMonkey(ArduCopter())
    monkey.press(DOWN)
    monkey.run(1.0)
    assert monkey.lowered > 3
    monkey.release(DOWN)
    monkey.run(0.5)
    seen = monkey.lowered
    monkey.run(2.0)
    assert monkey.lowered == seen
    last = monkey.copter.all(m.ManualControl)[-1][1]
    assert last.z == HOVER


@pytest.mark.slow
@pytest.mark.parametrize("build", [ArduCopter, Px4Quad], ids=["arducopter", "px4"])
@settings(max_examples=examples(25), phases=[Phase.reuse, Phase.generate], deadline=None)
@given(steps=st.lists(st.tuples(STEPS, PAUSES), min_size=3, max_size=20))
def test_nothing_but_a_held_key_sends_it_down(
    build: type[ArduCopter | Px4Quad], steps: list[tuple[Step, float]]
) -> None:
    monkey = FlightMonkey(build())
    for (name, argument), pause in steps:
        getattr(monkey, name)(argument)
        monkey.run(pause)
    monkey.world.near.frozen = False
    monkey.run(2.0)
