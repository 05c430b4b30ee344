"""A monkey at keys, screen, processes and link in any order: the bounds of docs/safety.md hold at every moment.

Wheels turn only within 1 s of the sending of a demand that is not neutral, however late the link is. Such a demand is
sent only within the longest wait for an auto-repeat, within the lease of the screen, and with the key gate open.
"""

from __future__ import annotations

import math
from typing import Any

import pytest
from hypothesis import Phase, given, settings
from hypothesis import strategies as st

from dialects.axes import FULL_DEFLECTION
from dialects.messages import ManualControl, RoverOperatorPresence
from dialects.modes import Mode
from groundstation.intents.driving import Stop
from groundstation.intents.session import SetKeyGate
from groundstation.intents.union import AnyIntent
from groundstation.intents.vehicle import Arm, Disarm, SetMode
from tests.examples import examples
from tests.test_stops import NEUTRAL_WITHIN, REPEAT, Drive

SLACK = 0.04
"""s: two control cycles."""
REPEAT_WITHIN = 1.1
"""s from the last key event to neutral, for a keyboard that begins to repeat late."""
LEASE = 0.3
"""s for which a screen may be silent."""

Step = tuple[Any, ...]
"""Name of a method of Monkey, its argument, and the s that pass after it."""


class Monkey(Drive):
    """A drive that checks the bounds at each step of time."""

    def __init__(self, style: str, session: int = 0) -> None:
        self.last_demand = self.last_key = self.last_lease = -math.inf
        self.gate_closed_at = math.inf
        self._seen = 0
        self._style = style
        self.turned = 0.0
        """s in which the wheels turned."""
        super().__init__(style=style, session=session)

    # ---- what the monkey does ----

    def key(self, held: bool) -> None:
        self.held = "i" if held else None

    def stop_key(self, _: bool) -> None:
        self.held = None
        self._ask(Stop())

    def screen(self, lives: bool) -> None:
        self.screen_lives = lives

    def gate(self, is_open: bool) -> None:
        if not self.world.near.frozen:
            self.gate_closed_at = math.inf if is_open else self.world.now
        self._ask(SetKeyGate(is_open))

    def station_runs(self, runs: bool) -> None:
        self.world.near.frozen = not runs

    def link(self, works: bool) -> None:
        self.world.cut(not works)

    def delay(self, seconds: float) -> None:
        self.world.up.delay = self.world.down.delay = seconds
        self.world.up.jitter = self.world.down.jitter = seconds / 2

    def loss(self, share: float) -> None:
        self.world.up.loss = self.world.down.loss = share

    def mode(self, mode: Mode) -> None:
        self._ask(SetMode(mode.name))

    def arm(self, arms: bool) -> None:
        self._ask(Arm(held=1.0) if arms else Disarm())

    def forget(self) -> None:
        """Forget what was sent and how the wheels moved so far, so that a drive may last for days."""
        self.world.near.sent.clear()
        self.world.far.sent.clear()
        self.moved.clear()
        self._seen = 0

    # ---- what holds ----

    def _each(self, now: float) -> None:
        frozen = self.world.near.frozen
        if self.screen_lives and not frozen:
            self.last_lease = now
            self.last_key = now if self.held else self.last_key
        if not frozen:
            super()._each(now)
        self._check_sent()
        if self.power:
            self.turned += self.world.step
            assert now - self.last_demand <= NEUTRAL_WITHIN + SLACK

    def _check_sent(self) -> None:
        sent = self.world.near.sent
        for at, message in sent[self._seen :]:
            if isinstance(message, ManualControl | RoverOperatorPresence) and moves(message):
                self.last_demand = at
                assert at - self.last_lease <= LEASE + SLACK
                assert at <= self.gate_closed_at
                assert self._style == "latch" or at - self.last_key <= REPEAT_WITHIN + REPEAT + SLACK
        self._seen = len(sent)

    def _ask(self, intent: AnyIntent) -> None:
        if not self.world.near.frozen:
            self.tell(intent)


def moves(message: ManualControl | RoverOperatorPresence) -> bool:
    """Return whether a demand is not neutral; an axis beyond FULL_DEFLECTION is none."""
    return any(axis and abs(axis) <= FULL_DEFLECTION for axis in (message.x, message.r))


ANSWERS = st.booleans()
STEPS: st.SearchStrategy[Step] = st.one_of(
    st.tuples(st.just("key"), ANSWERS),
    st.tuples(st.just("key"), st.just(True)),  # most often, or there is nothing to stop
    st.tuples(st.just("stop_key"), ANSWERS),
    st.tuples(st.just("screen"), ANSWERS),
    st.tuples(st.just("gate"), ANSWERS),
    st.tuples(st.just("station_runs"), ANSWERS),
    st.tuples(st.just("link"), ANSWERS),
    st.tuples(st.just("delay"), st.sampled_from([0.0, 0.02, 0.15, 0.4, 1.5])),
    st.tuples(st.just("loss"), st.sampled_from([0.0, 0.1, 0.4])),
    st.tuples(st.just("mode"), st.sampled_from([Mode.MANUAL, Mode.HOLD])),
    st.tuples(st.just("arm"), ANSWERS),
)
PAUSES = st.sampled_from([0.01, 0.1, 0.35, 0.6, 1.2])
"""s between two steps."""


@pytest.mark.slow
@pytest.mark.parametrize("style", ["hold", "latch"])
@settings(max_examples=examples(25), phases=[Phase.reuse, Phase.generate])  # shrinking would take minutes
@given(steps=st.lists(st.tuples(STEPS, PAUSES), min_size=3, max_size=25))
def test_whatever_happens_the_wheels_stop_in_time(style: str, steps: list[tuple[Step, float]]) -> None:
    monkey = Monkey(style)
    monkey.get_going()
    assert monkey.turned > 0.0
    for (name, argument), pause in steps:
        getattr(monkey, name)(argument)
        monkey.run(pause)
    monkey.world.near.frozen = False
    monkey.stop_key(True)
    monkey.run(NEUTRAL_WITHIN + SLACK)
    monkey.moved.clear()
    monkey.run(1.0)
    assert max(power for _, power in monkey.moved) == 0.0
