"""The same rig and oracle under sequences that hypothesis draws: longer, with times and losses between the events.

`MAVHELM_MACHINE=all` draws long sequences.
"""

from __future__ import annotations

import os
from typing import Any

from hypothesis import HealthCheck, settings
from hypothesis import strategies as st
from hypothesis.stateful import RuleBasedStateMachine, precondition, rule

from dialects.axes import Axes
from tests.examples import examples
from tests.vehicle.machine.events import ALL_HAZARDS, ALL_STOPS, ALL_THREE, Event
from tests.vehicle.machine.rig import AHEAD, CYCLE, NEUTRAL, Rig
from vehicle.safety.states import SafetyState

EVENTS: dict[str, Event] = {**ALL_THREE, **ALL_STOPS, **ALL_HAZARDS}
LONG = os.environ.get("MAVHELM_MACHINE") == "all"
STICKS = st.sampled_from([NEUTRAL, AHEAD])
NAMES = st.sampled_from(["A", "A", "B", "T"])


class RoverMachine(RuleBasedStateMachine):
    """Draws events, demands that are late, lost, doubled or in another order, jumps of time, and restarts."""

    def __init__(self) -> None:
        super().__init__()
        self.rig = Rig(mission=True)
        self.late: list[tuple[Axes, float, int]] = []

    @rule(name=st.sampled_from(sorted(EVENTS)))
    def event(self, name: str) -> None:
        """One of the events of the exhaustive search."""
        EVENTS[name](self.rig)

    @rule(name=NAMES, axes=STICKS, cycles=st.integers(1, 12), loss=st.sets(st.integers(0, 11)))
    def stream(self, name: str, axes: Axes, cycles: int, loss: set[int]) -> None:
        """A demand in each cycle, some of them lost."""
        for number in range(cycles):
            self.rig.cycle()
            if number not in loss:
                self.rig.demand(name, axes)

    @rule(axes=STICKS)
    def delay(self, axes: Axes) -> None:
        """A demand of A that is under way."""
        self.late.append((axes, self.rig.now, self.rig.clocks.messages + 1))
        self.rig.clocks.messages += 1

    @precondition(lambda self: self.late)
    @rule(data=st.data(), copies=st.integers(1, 2))
    def arrive(self, data: Any, copies: int) -> None:
        """A demand that was under way arrives, perhaps before older ones, perhaps twice."""
        axes, sent, clock = self.late.pop(data.draw(st.integers(0, len(self.late) - 1)))
        for _ in range(copies):
            self.rig.demand("A", axes, age=self.rig.now - sent + 0.02, clock=clock)

    @rule(seconds=st.sampled_from([0.1, 0.36, 0.45, 0.72, 1.08, 6.0]))
    def silence(self, seconds: float) -> None:
        """Nobody says anything."""
        self.rig.wait(seconds)

    @rule(gap=st.sampled_from([0.0, 0.001, CYCLE, 0.11, 0.19, 0.21, 5.0]))
    def jump(self, gap: float) -> None:
        """The next cycle comes early, late or very late."""
        self.rig.cycle(gap)

    @precondition(lambda self: self.rig.rover.state is SafetyState.OFF or self.rig.oracle.terminated)
    @rule()
    def restart(self) -> None:
        """The program is started again; the ground stations go on."""
        self.rig = Rig(mission=True)
        self.late.clear()


RoverMachine.TestCase.settings = settings(
    max_examples=2000 if LONG else examples(15),
    stateful_step_count=200 if LONG else 40,
    deadline=None,
    suppress_health_check=[HealthCheck.too_slow],
)
TestRover = RoverMachine.TestCase
