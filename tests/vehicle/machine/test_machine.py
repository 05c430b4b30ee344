"""Control, arming, mode, failsafes and identity: every event in every state that can be reached.

`MAVHELM_MACHINE=all` also explores all three programs together, which takes minutes. Where MAVHELM_EXAMPLES asks for
fewer examples, as in CI, the exploration ends after FIRST transitions.
"""

from __future__ import annotations

import math
import os
import time
from typing import NamedTuple

import pytest

from dialects.modes import Mode
from tests.examples import FULL, asked
from tests.vehicle.machine import explore
from tests.vehicle.machine.events import (
    ALL_HAZARDS,
    ALL_STOPS,
    ALL_THREE,
    BATTERY,
    DRIVER,
    FAULTS,
    POSITION,
    RIVALS,
    STOPS,
    TWINS,
    Event,
)
from tests.vehicle.machine.explore import Description, Explorer
from tests.vehicle.machine.oracle import GCS_LOST
from tests.vehicle.machine.rig import AHEAD, NEUTRAL, Rig
from vehicle.safety.states import SafetyState


class Domain(NamedTuple):
    """Events, and what else tells two states apart."""

    events: dict[str, Event]
    more: Description
    least: int
    """Fewer states than this mean that the exploration misses some."""
    mission: bool = False


DOMAINS = {
    "two programs with the same ids": Domain(TWINS, explore.identity, 200),
    "two ground stations": Domain(RIVALS, explore.identity, 200),
    "emergency stop": Domain(STOPS, explore.stops, 200),
    "faults": Domain(FAULTS, explore.stops, 200),
    "battery": Domain(BATTERY, explore.stops, 200),
    "position": Domain(POSITION, explore.hazards, 200, mission=True),
}
FIRST = math.inf if asked() >= FULL else 3000
ALL = os.environ.get("MAVHELM_MACHINE") == "all"
PATIENCE = 6 * 3600 if ALL else 600
"""s, on a machine that other programs keep busy."""
if ALL:
    DOMAINS |= {
        "three programs": Domain(ALL_THREE, explore.identity, 1000),
        "all stops": Domain(ALL_STOPS, explore.stops, 1000),
        "all failsafes": Domain(ALL_HAZARDS, explore.hazards, 1000, mission=True),
    }


@pytest.mark.timeout(PATIENCE)
@pytest.mark.parametrize("name", DOMAINS)
def test_the_rules_hold_in_every_state_under_every_event(name: str) -> None:
    domain, began = DOMAINS[name], time.process_time()
    explored = Explorer(Rig(mission=domain.mission), domain.events, domain.more).run(FIRST)
    seconds = time.process_time() - began
    print(f"{name}: {len(explored.states)} states, {explored.transitions} transitions, {seconds:.1f} s")
    assert len(explored.states) >= domain.least
    assert {state[0] for state in explored.states} >= {SafetyState.SAFE, SafetyState.ARMED}
    assert any(state[explore.MOVING] for state in explored.states), "it never drives"


def test_the_oracle_sees_the_wheels_turn_and_stop() -> None:
    rig = Rig()
    rig.demand("A", NEUTRAL)
    TWINS["A arms"](rig)
    rig.demand("A", NEUTRAL)
    rig.wait(0.5, "A", AHEAD)
    assert rig.oracle.permitted == rig.now
    assert all(rig.rover.outputs.throttles)
    rig.wait(2.0)
    assert not any(rig.rover.outputs.throttles)


def test_program_without_proofs_succeeds_session_at_its_address() -> None:
    """Found by 2000 sequences of 200 steps: the oracle took it for the session, which is silent."""
    rig = Rig(mission=True)
    DRIVER["A arms"](rig)
    rig.wait(GCS_LOST + 1.0)
    for _ in range(3):  # frames that make it a program
        rig.mode("A", Mode.MANUAL)
    assert rig.rover._control.ownership.driver is not None
    assert rig.rover._control.ownership.session is None
    rig.cycle()  # the loss ends
    rig.mode("A", Mode.AUTO)
    rig.wait(0.9)
    assert any(rig.rover.outputs.throttles)
    rig.wait(GCS_LOST + 1.0)
    assert not any(rig.rover.outputs.throttles)


@pytest.mark.timeout(PATIENCE)
@pytest.mark.parametrize("hole", ["neutral", "stop", "age"])
def test_the_oracle_finds_a_hole(hole: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """With a rule taken out of the rover, the exploration fails."""
    if hole == "neutral":
        monkeypatch.setattr("vehicle.drive.control.Control.require_neutral", lambda self: None)
    elif hole == "stop":
        monkeypatch.setattr("vehicle.safety.state_machine.Safety.release_estop", lambda self, now: None)
        monkeypatch.setitem(STOPS, "nothing", lambda rig: setattr(rig.rover._safety, "state", SafetyState.SAFE))
    else:
        monkeypatch.setattr("vehicle.drive.control.Control.demand_timeout", 5.0)
    with pytest.raises(AssertionError, match=" after "):
        Explorer(Rig(), STOPS, explore.stops).run()
