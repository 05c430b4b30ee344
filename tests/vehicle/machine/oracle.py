"""What must hold in every state of the rover, judged by what happened and not by what the rover says of itself.

The oracle follows the messages that arrive and the surroundings, keeps its own account of who has shown neutral, whose
demand is fresh, and what is stopped, and compares the rover with it after each message and each cycle.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from statistics import mean
from typing import TYPE_CHECKING, NamedTuple

from dialects.enums import Result
from dialects.modes import Mode
from vehicle.modes import MODES
from vehicle.rover import Rover
from vehicle.safety.monitor import LATE_CYCLE_TIME
from vehicle.safety.states import SafetyState

if TYPE_CHECKING:
    from tests.vehicle.machine.rig import Surroundings

DEMAND_AGE = 0.45
PROOF_AGE = 1.0
GCS_LOST = 2.0
ANSWER_WITHIN = 10.0
SUCCESSION = 0.7
SETPOINT_AGE = 1.0
POSITION_AGE = 3.0
SLACK = 0.1
"""s: one cycle of the rig, in which a failsafe may still be found."""
STOP_TIME = 0.4 + 3 * SLACK
"""s from the loss of the permit to zero: the ramp from full, and the cycles in which it begins and ends."""
STOPS = ("disarm", "estop", "terminate", "mode HOLD")
DRIVER_IDS = {"A": 255, "T": 255, "B": 254, "S": 200, "": 0}


class Seen(NamedTuple):
    """What the rover shows, before and after a step."""

    state: SafetyState
    mode: Mode
    owner: str
    takeover: bool
    throttles: tuple[float, ...]
    session: bool
    """The driver is an operator session."""
    inside: tuple[object, ...]
    """What only the driver may change."""


def look(rover: Rover) -> Seen:
    """Return what the rover shows now."""
    control, safety = rover._control, rover._safety
    driver = control.ownership.driver
    owner = str(driver.conversation.peer.address) if driver else ""
    inside = (control.neutral_seen, control.demand, safety.autonomy_confirmed, safety.mode_generation,
              rover._navigator.guided.target, rover._navigator.paused, control.ownership.takeover_allowed)  # fmt: skip
    session = control.ownership.session is not None
    takeover, throttles = control.ownership.takeover_allowed, rover.outputs.throttles
    return Seen(safety.state, safety.mode, owner, takeover, throttles, session, inside)


@dataclass
class Oracle:
    """Its own account, and the checks."""

    now: float
    heard: dict[str, float] = field(default_factory=dict)
    """When each station said something that shows that it is alive."""
    proven: float = -math.inf
    """When A sent its newest good proof."""
    by_session: bool = False
    """The driver took control with a proof."""
    neutral: bool = False
    """The driver has shown neutral since the last event that requires it."""
    moving: bool = False
    demand_at: float = -math.inf
    confirmed: bool = False
    """The driver has asked an autonomous mode to drive since the last event that ends it."""
    setpoint_at: float = -math.inf
    stopped: bool = False
    """Emergency stop."""
    terminated: bool = False
    position_at: float = math.inf
    """When the position was lost."""
    asked: dict[str, float] = field(default_factory=dict)
    """When each station was refused control, of those that the driver may give it to."""
    owner_seen: float = -math.inf
    permitted: float = -math.inf

    # ---- around a step ----

    def before(self, rover: Rover, name: str, act: str, now: float, *, good: bool = False) -> None:
        """Remember what the rover shows, and what is about to happen."""
        self.was, self.name, self.act, self.good = look(rover), name, act, good
        self._lapse(now)

    def after_message(self, rover: Rover, result: Result | None, around: Surroundings, now: float) -> None:
        """Check what a message has done."""
        accepted, seen = result is Result.ACCEPTED, look(rover)
        self._check_owner(seen, accepted, now)
        self._check_state(seen, around, accepted)
        self._check_mode(seen, accepted)
        self._check_stranger(seen)
        self._note(seen, accepted, now)
        self._note_asked(seen, accepted, now)
        self._check_motion(rover, seen, around, now, late=False)

    def after_cycle(self, rover: Rover, around: Surroundings, now: float, gap: float) -> None:
        """Check what a cycle, or an event around the rover, has done."""
        seen = look(rover)
        self.stopped |= around.button and seen.state is not SafetyState.OFF
        self.position_at = math.inf if around.position else min(self.position_at, now)
        self._check_owner(seen, False, now)
        self._check_state(seen, around, False)
        self._check_mode(seen, False)
        self._note(seen, False, now)
        self._check_motion(rover, seen, around, now, late=gap > LATE_CYCLE_TIME)

    # ---- control ----

    def _check_owner(self, seen: Seen, accepted: bool, now: float) -> None:
        if seen.owner == self.was.owner:
            if self._ends_session(seen):
                silent = now - self.owner_seen > GCS_LOST or self.was.takeover
                assert self.name == seen.owner and self.act and silent, "a session was ended"  # noqa: PT018
            return
        silence = now - self.owner_seen
        succeeds = DRIVER_IDS[self.name] == DRIVER_IDS[self.was.owner] and silence > SUCCESSION and self.act != ""
        if not seen.owner:  # the successor of a silent driver may release at once
            freed = self.act == "release" and accepted and (self.name == self.was.owner or succeeds)
            assert freed or (seen.state is not SafetyState.ARMED and silence > GCS_LOST), "control was freed"
            return
        if self._is_given(seen, accepted, now):
            return
        assert seen.owner == self.name, "control went to somebody who did not ask"
        taken = self.act in ("arm", "force", "request") and accepted
        free = not self.was.owner or self.was.takeover or silence > GCS_LOST
        assert (taken and free) or succeeds, "control was taken"

    def asking(self, now: float) -> tuple[str, ...]:
        """Return the stations that wait for an answer to their request for control."""
        return tuple(name for name, at in self.asked.items() if now - at <= ANSWER_WITHIN)

    def _is_given(self, seen: Seen, accepted: bool, now: float) -> bool:
        """Return whether the driver gave control to a station that asked for it."""
        return self.act == "release" and accepted and self.name == self.was.owner and seen.owner in self.asking(now)

    def _note_asked(self, seen: Seen, accepted: bool, now: float) -> None:
        if self.act == "request":
            others = {name: at for name, at in self.asked.items() if name != self.name}
            self.asked = others if accepted else others | {self.name: now}
        elif self.act == "release" and accepted:
            self.asked = {}

    def _ends_session(self, seen: Seen) -> bool:
        """Return whether the session in control was succeeded by a program without proofs at its own address."""
        return seen.owner == self.was.owner and self.was.session and not seen.session

    # ---- state and mode ----

    def _check_state(self, seen: Seen, around: Surroundings, accepted: bool) -> None:
        self._note_stops(seen, accepted, around)
        off = seen.state is SafetyState.OFF
        assert off or self.was.state is not SafetyState.OFF, "OFF was left"
        assert off or (seen.state is SafetyState.ESTOP) == self.stopped, "the emergency stop was left, or not entered"
        assert off or not around.fault or seen.state in (SafetyState.FAULT, SafetyState.ESTOP), "a fault is ignored"
        if seen.state is SafetyState.ARMED:
            assert self.act not in ("disarm", "estop", "terminate"), "a stop did not stop"
        if seen.state is SafetyState.ARMED and self.was.state is not SafetyState.ARMED:
            assert self._takes(accepted), "armed by itself"
            assert self.name != "S", "armed by a station without a HEARTBEAT"
            assert self.was.state is SafetyState.SAFE, "armed from another state"
            assert seen.owner == self.name, "armed for another station"
            assert self.act == "force" or around.battery == "ok", "armed with an empty battery"

    def _note_stops(self, seen: Seen, accepted: bool, around: Surroundings) -> None:
        alive = self.was.state is not SafetyState.OFF
        self.stopped |= alive and self.act in ("estop", "terminate")
        self.terminated |= alive and self.act == "terminate"
        if self.act == "unstop" and accepted:
            barred = around.button or self.terminated
            assert not barred, "released although it must not be"
            assert self._may_command(seen), "released by another"
            self.stopped = False

    def _may_command(self, seen: Seen) -> bool:
        """Return whether the sender is in control, has succeeded a silent driver with its ids, or nobody is."""
        return self.name != "S" and (self.was.owner in ("", self.name) or seen.owner == self.name)

    def _check_mode(self, seen: Seen, accepted: bool) -> None:
        asked = self.act.removeprefix("mode ") if self.act.startswith("mode ") and accepted else ""
        if asked:
            assert seen.mode.name == asked, "another mode than the one that was chosen"
            assert asked == "HOLD" or self._may_command(seen), "a stranger chose a mode"
        elif seen.mode is not self.was.mode:
            assert seen.mode is Mode.HOLD, "a mode was left for another one than HOLD"

    def _check_stranger(self, seen: Seen) -> None:
        """A station that is not in control changes nothing but by a stop."""
        if not self.was.owner or self.name == self.was.owner or self.act in STOPS or seen.owner != self.was.owner:
            return
        assert seen._replace(throttles=()) == self.was._replace(throttles=()), "a stranger changed something"
        pairs = zip(seen.throttles, self.was.throttles, strict=True)
        assert all(abs(new) <= abs(old) for new, old in pairs), "a stranger moved the rover"

    # ---- the oracle's account ----

    def _lapse(self, now: float) -> None:
        if self.moving and now - self.demand_at > DEMAND_AGE:
            self.neutral = False

    def _note(self, seen: Seen, accepted: bool, now: float) -> None:
        if self.name == "A" and self.good:
            self.proven = now
        if seen.owner != self.was.owner or self._takes(accepted) or self._ends_session(seen):
            self._note_driver(seen, accepted, now)
        self._note_life(seen, now)
        if seen.state is not SafetyState.ARMED or (self.act in ("arm", "force") and self.was.state != seen.state):
            self._forget()
        if seen.mode is not self.was.mode:
            self._forget(confirmed=MODES[seen.mode].autonomous)
        if self.act == f"mode {seen.mode.name}" and accepted:
            self.confirmed = MODES[seen.mode].autonomous and seen.state is SafetyState.ARMED
        self._note_demand(seen, now)

    def _note_driver(self, seen: Seen, accepted: bool, now: float) -> None:
        """Note who takes control: by the session that was proven in the last second, or without one."""
        proven = seen.owner == "A" and now - self.proven <= PROOF_AGE and not self._ends_session(seen)
        if seen.owner != self.was.owner or (self.by_session and not proven):
            granted = self.act in ("request", "release") and accepted
            self._forget(confirmed=self.confirmed and granted)
            self.by_session = False
        self.by_session |= proven

    def _takes(self, accepted: bool) -> bool:
        """Return whether a station takes control, perhaps again."""
        arms = self.act in ("arm", "force") and self.was.state is not SafetyState.ARMED
        return accepted and (arms or self.act == "request")

    def _note_life(self, seen: Seen, now: float) -> None:
        if self.act == "release" and seen.owner not in ("", self.was.owner):
            self.owner_seen = now
        elif self.name and self.name == seen.owner:
            silent = self.by_session and not self.good and seen.owner == self.was.owner
            self.owner_seen = self.owner_seen if silent else now

    def _forget(self, *, confirmed: bool = False) -> None:
        self.neutral, self.moving, self.demand_at, self.confirmed = False, False, -math.inf, confirmed
        self.setpoint_at = -math.inf

    def _note_demand(self, seen: Seen, now: float) -> None:
        if not self.name or self.name != seen.owner:
            return
        if self.act == "setpoint" and seen.mode is Mode.GUIDED and seen.state is SafetyState.ARMED:
            self.confirmed, self.setpoint_at = True, now
        counts = self.good if self.by_session else not self.act.startswith("proof")
        if self.act.removeprefix("proof ") in ("ahead", "neutral") and counts:
            self.moving, self.demand_at = self.act.endswith("ahead"), now
            self.neutral |= not self.moving
        elif self.act == "proof old neutral" and self.by_session:
            self.moving = False

    # ---- motion ----

    def _permits(self, seen: Seen, around: Surroundings, now: float) -> bool:
        """Return whether motors may have power now."""
        if seen.state is not SafetyState.ARMED or self.stopped or around.fault or around.button or not seen.owner:
            return False
        if MODES[seen.mode].manual:
            return self.neutral and self.moving and now - self.demand_at <= DEMAND_AGE
        if not (MODES[seen.mode].autonomous and self.confirmed and now - self.owner_seen <= GCS_LOST + SLACK):
            return False
        if seen.mode is Mode.GUIDED:
            return now - self.setpoint_at <= SETPOINT_AGE + SLACK
        return now - self.position_at <= POSITION_AGE + SLACK

    def _check_motion(self, rover: Rover, seen: Seen, around: Surroundings, now: float, *, late: bool) -> None:
        outputs = rover.outputs
        if self._permits(seen, around, now):
            self.permitted = now
        elif any(outputs.throttles):
            falling = zip(outputs.throttles, self.was.throttles, strict=True)
            assert all(abs(new) <= abs(old) for new, old in falling), "faster without a permit"
        if seen.state is not SafetyState.ARMED or late:
            assert not any(outputs.throttles), "the wheels turn"
            assert not outputs.enabled, "motors have power"
        if any(outputs.throttles):
            assert outputs.enabled
            assert now - self.permitted <= STOP_TIME, "the wheels turn on"
        if around.battery != "ok" and self.permitted == now:
            assert abs(mean(outputs.throttles)) <= max(0.5, abs(mean(self.was.throttles))), "too fast for the battery"
