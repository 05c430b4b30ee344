"""Try every event in every state that can be reached, breadth first, on one live rover.

A state is what `describe` says of it: times count as fresh or stale, sensors as good or bad. Of each state the first
example that is found is explored.
"""

from __future__ import annotations

import copy
import math
from collections import deque
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

from tests.vehicle.machine.oracle import DEMAND_AGE, STOP_TIME
from tests.vehicle.machine.rig import STATIONS, Rig
from tests.vehicle.machine.snapshot import Snapshots
from vehicle.drive.conversation import Conversation
from vehicle.modes import MODES

Event = Callable[[Rig], None]
MOVING = 11
"""Where a state says that motors have power."""
State = tuple[object, ...]
Description = Callable[[Rig], State]


def describe(rig: Rig, more: Description) -> State:
    """Return the abstract state: what decides what the next event does; `more` is what matters to its events."""
    rover, around, oracle = rig.rover, rig.around, rig.oracle
    safety, control = rover._safety, rover._control
    demand = control.demand
    return (
        safety.state, safety.mode, safety.terminated, safety.loop_overrun,
        safety.autonomy_confirmed and MODES[safety.mode].autonomous,
        around.button, around.fault, around.battery, around.position,
        demand and (control.requests_motion(), control.is_demand_stale(rig.now)), control.neutral_seen,
        any(rover.outputs.throttles), oracle.by_session, control.ownership.driver is not None, *more(rig),
    )  # fmt: skip


def motion(rig: Rig) -> State:
    """Return what the oracle knows of the demand: states in which it and the rover differ are apart."""
    oracle, now = rig.oracle, rig.now
    fresh = oracle.moving and now - oracle.demand_at <= DEMAND_AGE
    return oracle.neutral, fresh, now - oracle.permitted <= STOP_TIME


def stops(rig: Rig) -> State:
    """Return whether a failsafe holds."""
    return bool(rig.rover._safety.failsafes.active), *motion(rig)


def identity(rig: Rig) -> State:
    """Return who is in control, since when it is silent, and what is known of the others."""
    ownership, now = rig.rover._control.ownership, rig.now
    driver = ownership.driver
    return (
        driver and (driver.conversation.peer.address, driver.session is not None, driver.is_copy),
        driver and sum(ownership.silence_duration(now) > limit for limit in (0.7, 2.0)),
        ownership.takeover_allowed, ownership._proofs.session_of(_conversation("A"), now) is not None,
        _is_program(rig, "T"), bool(rig.rover._safety.failsafes.active), rig.oracle.asking(now),
    )  # fmt: skip


def hazards(rig: Rig) -> State:
    """Return whether there is a driver, which failsafes hold and what they have done, and what drives by itself."""
    rover, now = rig.rover, rig.now
    failsafes, ownership = rover._safety.failsafes, rover._control.ownership
    return (
        ownership.is_lost(now), rover._navigator.estimate.good,
        failsafes.latched, failsafes.active, failsafes.lasting_action(now), rover._navigator.guided.target is not None,
        *motion(rig),
    )  # fmt: skip


def _conversation(name: str) -> Conversation:
    station = STATIONS[name]
    return Conversation(station.system, 190, station.peer, 1)


def _is_program(rig: Rig, name: str) -> bool:
    newcomer = rig.rover._control.ownership._memory.newcomer(_conversation(name))
    return newcomer is not None and newcomer.is_program


@dataclass
class Explored:
    """What an exploration has seen."""

    states: dict[State, tuple[str, ...]] = field(default_factory=dict)
    """State -> the events that lead to it."""
    transitions: int = 0


class Explorer:
    """Explores the states of one rig."""

    def __init__(self, rig: Rig, events: Mapping[str, Event], more: Description) -> None:
        self._rig, self._events, self._more = rig, events, more
        handlers = [getattr(spec.run, "__self__", None) for spec in rig.rover.commands]
        self._snapshots = Snapshots([rig.rover, *handlers])  # handlers of commands know who asks for control
        self.explored = Explored()

    def run(self, most: float = math.inf) -> Explored:
        """Try every event in every state; raises AssertionError with the events that lead to what must not be.

        `most`: end after so many transitions; those of the fewest events come first.
        """
        waiting: deque[tuple[tuple[str, ...], Any]] = deque([((), self._save())])
        self.explored.states[describe(self._rig, self._more)] = ()
        while waiting and self.explored.transitions < most:
            path, saved = waiting.popleft()
            for name, event in self._events.items():
                self._restore(saved)
                self._perform(name, event, path)
                state = describe(self._rig, self._more)
                if state not in self.explored.states:
                    self.explored.states[state] = (*path, name)
                    waiting.append(((*path, name), self._save()))
        return self.explored

    def _perform(self, name: str, event: Event, path: tuple[str, ...]) -> None:
        self.explored.transitions += 1
        try:
            event(self._rig)
        except AssertionError as error:
            raise AssertionError(f"{error} after {', '.join((*path, name))}") from error

    def _save(self) -> Any:
        rig = self._rig
        return self._snapshots.save(), copy.copy(rig.clocks), copy.copy(rig.around), copy.deepcopy(rig.oracle)

    def _restore(self, saved: Any) -> None:
        rig = self._rig
        self._snapshots.restore(saved[0])
        rig.clocks, rig.around, rig.oracle = copy.copy(saved[1]), copy.copy(saved[2]), copy.copy(saved[3])
