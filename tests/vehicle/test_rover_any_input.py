"""Whatever comes in whatever order: the rover moves only for a fresh demand of its driver, and nothing raises.

Disarmed it turns one wheel at most, slowly, as long as somebody asked for, and not after any stop.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

from hypothesis import given, settings
from hypothesis import strategies as st

from dialects import codec
from dialects import messages as m
from dialects.axes import Axes, build_manual_control
from dialects.enums import Command, Result
from dialects.modes import Mode
from link.core import Peer, Received
from tests.examples import examples
from tests.vehicle.bench import CYCLE, DRIVER, OTHER, Bench
from vehicle.modes import MODES
from vehicle.params import Params
from vehicle.safety import states
from vehicle.safety.failsafe import FailsafeAction
from vehicle.safety.monitor import LATE_CYCLE_TIME

TIMEOUT = Params()["MAN_TIMEOUT"]
STOP_TIME = 100 / Params()["MOT_DECEL"] + 3 * CYCLE + LATE_CYCLE_TIME
"""s from a lost permit to zero: the ramp, the cycles it takes to begin and to end, and one that comes late."""
BAND = 0.03
Step = tuple[Any, ...]
"""Name of a method of Script, and its arguments."""


@dataclass
class Witness:
    """What an outside observer of the wire knows; it believes nothing the rover says but who is in control."""

    bench: Bench
    owner: int = 0
    last_demand: float = -math.inf
    neutral_seen: bool = False
    moving: bool = False
    permitted: float = -math.inf
    """When motion was last permitted."""
    before: tuple[float, ...] = (0.0, 0.0)
    tested: float = -math.inf
    """Until when a motor test may turn a wheel."""

    def demand(self, axes: Axes, system: int) -> None:
        if system != self.bench.rover._control.ownership.owner:
            return
        self._lapse()
        self.last_demand = self.bench.now
        rest = abs(axes.throttle) <= BAND and abs(axes.steering) <= BAND
        self.neutral_seen |= rest
        self.moving = not rest

    def check(self) -> None:
        """The invariant, after every step."""
        rover, now = self.bench.rover, self.bench.now
        self._lapse()
        if rover._control.ownership.owner != self.owner:
            self.owner, self.neutral_seen, self.last_demand = rover._control.ownership.owner, False, -math.inf
        if rover.state is not states.SafetyState.ARMED:
            self._disarmed()
            return
        self.tested = -math.inf
        if self.neutral_seen and now - self.last_demand <= TIMEOUT:
            self.permitted = now
        if any(rover.outputs.throttles):
            assert rover.outputs.enabled
            assert now - self.permitted <= STOP_TIME
        if self.permitted != now:
            falling = zip(rover.outputs.throttles, self.before, strict=True)
            assert all(abs(new) <= abs(old) for new, old in falling)
        assert all(math.isfinite(value) and abs(value) <= 1 for value in rover.outputs.throttles)
        if (
            not MODES[rover._safety.mode].manual
            or rover._safety.failsafes.lasting_action(now) >= FailsafeAction.NEUTRAL
        ):
            assert all(abs(new) <= abs(old) for new, old in zip(rover.outputs.throttles, self.before, strict=True))
        self.before = rover.outputs.throttles

    def _disarmed(self) -> None:
        outputs = self.bench.rover.outputs
        if turns := [value for value in outputs.throttles if value]:
            assert self.bench.now < self.tested
            assert len(turns) == 1
            assert abs(turns[0]) <= 0.3
        assert not outputs.enabled or self.bench.now < self.tested
        self.neutral_seen, self.permitted, self.before = False, -math.inf, (0.0, 0.0)

    def _lapse(self) -> None:
        if self.moving and self.bench.now - self.last_demand > TIMEOUT:
            self.neutral_seen = False


SYSTEMS = st.sampled_from([DRIVER, DRIVER, DRIVER, OTHER])
WISHES = st.sampled_from([Axes(), Axes(), Axes(1.0), Axes(-1.0, 0.5), Axes(0.0, 1.0), Axes(0.02, 0.0), Axes(1.0, 1.0)])
NUMBERS = st.sampled_from([0.0, 1.0, 2.0, 0.5, 21196.0, 4.0, math.nan, -1.0, 255.0, 254.0, 1e30])
COMMANDS = st.sampled_from(
    [
        Command.COMPONENT_ARM_DISARM,
        Command.DO_SET_SAFETY_SWITCH_STATE,
        Command.DO_SET_MODE,
        Command.REQUEST_OPERATOR_CONTROL,
    ]
)
STEPS = st.one_of(
    st.tuples(
        st.just("wait"), st.sampled_from([0.02, 0.1, 0.3, 0.46, 1.0, 2.1, 6.0]), st.one_of(st.none(), WISHES), SYSTEMS
    ),
    st.tuples(st.just("wait"), st.sampled_from([0.1, 0.5]), WISHES, st.just(DRIVER)),
    st.tuples(st.just("stick"), WISHES, SYSTEMS),
    st.tuples(st.just("arm"), SYSTEMS),
    st.tuples(st.just("manual"), SYSTEMS),
    st.tuples(st.just("command"), COMMANDS, NUMBERS, NUMBERS, SYSTEMS),
    st.tuples(st.just("freeze"), st.sampled_from([0.05, 0.15, 0.3])),
    st.tuples(st.just("motor"), st.booleans()),
    st.tuples(st.just("test"), st.sampled_from([1, 2]), st.sampled_from([30.0, -10.0, 31.0, 100.0, math.nan]),
              st.sampled_from([0.5, 1.0, 3.0, 4.0, -1.0]), SYSTEMS),
)  # fmt: skip


@dataclass
class Script:
    """One method a kind of step."""

    bench: Bench
    witness: Witness

    def play(self, step: Step) -> None:
        getattr(self, step[0])(*step[1:])
        self.witness.check()

    def wait(self, seconds: float, axes: Axes | None, system: int) -> None:
        end = self.bench.now + seconds
        while self.bench.now + CYCLE <= end:
            self.bench.wait(CYCLE)
            self.witness.check()
            if axes is not None:
                self.stick(axes, system)

    def stick(self, axes: Axes, system: int) -> None:
        self.witness.demand(axes, system)
        self.bench.stick(axes, system)
        self.witness.check()

    def arm(self, system: int) -> None:
        self.bench.arm(system)

    def manual(self, system: int) -> None:
        self.bench.set_mode(Mode.MANUAL, system)

    def command(self, command: int, first: float, second: float, system: int) -> None:
        if self.bench.command(command, first, second, system=system) is Result.ACCEPTED and command in STOPS:
            self.witness.tested = -math.inf if first == 0 else self.witness.tested

    def test(self, motor: int, percent: float, seconds: float, system: int) -> None:
        if self.bench.command(Command.DO_MOTOR_TEST, motor, 0, percent, seconds, system=system) is Result.ACCEPTED:
            assert abs(percent) <= 30
            self.witness.tested = self.bench.now + seconds

    def freeze(self, seconds: float) -> None:
        """A process that does not run cannot act; the first thing it does when it runs again must be right."""
        self.bench.freeze(seconds)
        self.bench.cycle()
        if seconds > LATE_CYCLE_TIME:
            self.witness.tested = -math.inf

    def motor(self, works: bool) -> None:
        rover = self.bench.rover
        rover.motor_repaired(self.bench.now) if works else rover.motor_failed("broken", self.bench.now)
        if not works:
            self.witness.tested = -math.inf


STOPS = (Command.COMPONENT_ARM_DISARM, Command.DO_SET_SAFETY_SWITCH_STATE)


def going() -> Script:
    """Armed, neutral shown, full ahead."""
    bench = Bench()
    script = Script(bench, Witness(bench))
    script.arm(DRIVER)
    script.wait(0.1, Axes(), DRIVER)
    script.wait(0.3, Axes(1.0), DRIVER)
    return script


@settings(max_examples=examples(120))
@given(st.lists(STEPS, max_size=40))
def test_it_moves_only_for_a_fresh_demand_of_its_driver(steps: list[Step]) -> None:
    script = going()
    for step in steps:
        script.play(step)


def test_the_witness_sees_motion() -> None:
    """The test above can fail: its rover does drive."""
    script = going()
    assert script.bench.turning
    assert script.witness.permitted == script.bench.now


@settings(max_examples=examples(120))
@given(st.lists(STEPS, max_size=20))
def test_disarmed_a_wheel_turns_for_a_motor_test_only(steps: list[Step]) -> None:
    script = Script(bench := Bench(), Witness(bench))
    script.test(1, 30.0, 3.0, DRIVER)
    script.wait(0.3, None, DRIVER)
    assert bench.turning
    for step in steps:
        script.play(step)


FRAMES = st.tuples(
    st.sampled_from(sorted(m.MESSAGES)),
    st.binary(max_size=255),
    st.one_of(st.just(DRIVER), st.integers(1, 255)),
    st.integers(1, 255),
    st.booleans(),
)


@settings(max_examples=examples(80))
@given(st.lists(FRAMES, min_size=10, max_size=60))
def test_no_message_of_any_kind_raises(frames: list[tuple[int, bytes, int, int, bool]]) -> None:
    bench = Bench()
    bench.drive()
    for sequence, (number, payload, system, component, introduced) in enumerate(frames):
        message = codec.decode(number, payload)
        bench.rover.receive(Received(message, system, component, sequence, Peer(0, "x"), introduced), bench.now)
        bench.wait(CYCLE)


@settings(max_examples=examples(400))
@given(
    st.sampled_from([*Command, 65535]),
    st.lists(st.one_of(st.floats(width=32), NUMBERS), min_size=7, max_size=7),
    st.sampled_from([0, 1]),
    st.booleans(),
)
def test_no_command_raises_or_goes_unanswered(command: int, params: list[float], target: int, introduced: bool) -> None:
    bench = Bench()
    answer = bench.command(command, *params, target=target, introduced=introduced)
    assert target == 0 or answer is not None
    bench.say(build_manual_control(Axes(), 1))
    bench.wait(0.1)
