"""Ticks are few while driving: what ends or changes a demand in between happens at its own time."""

from __future__ import annotations

from itertools import pairwise

import pytest

from dialects.modes import Mode
from groundstation.intents.driving import DriveKeyDown
from groundstation.intents.session import LEASE_TIMEOUT
from groundstation.station.driving.operator import NEUTRAL_LEAD
from groundstation.station.operator_core import TICK_PERIOD
from groundstation.vehicles.demand.demand_stream import DRIVING_PERIOD
from tests.groundstation.cockpits import FORWARD, armed_cockpit, driving_cockpit

STEP = 0.005
"""s of the virtual time."""


def test_the_lease_ends_at_its_time_and_not_at_the_next_tick() -> None:
    cockpit = driving_cockpit()
    for wait in (0.0, 0.02, 0.04, 0.06, 0.08):  # each phase of the ticks
        cockpit.run(0.5 + wait)
        cockpit.leasing = False
        renewed = cockpit._lease_due - 0.1
        took = cockpit.world.run_until(lambda: not cockpit.operator.throttle, 1.0)
        ended = cockpit.now - renewed
        assert took < TICK_PERIOD + LEASE_TIMEOUT
        assert LEASE_TIMEOUT < ended <= LEASE_TIMEOUT + 2 * STEP + 0.001
        cockpit.leasing = True
        cockpit.run(2.0)
        cockpit.do(FORWARD)
        cockpit.run(0.2)
        assert cockpit.operator.throttle


def test_a_key_that_is_no_longer_repeated_ends_at_its_time() -> None:
    cockpit = armed_cockpit()
    cockpit.run(1.0)
    for wait in (0.0, 0.02, 0.04, 0.06, 0.08):
        cockpit.run(1.5 + wait)
        cockpit.do(FORWARD)
        until = cockpit.station.operator.changes_at(cockpit.now)
        cockpit.run(STEP)
        assert cockpit.operator.throttle
        assert until is not None
        cockpit.run(cockpit.station.operator.sticks.stop_bound - 3 * STEP)
        assert cockpit.operator.throttle
        cockpit.run(4 * STEP)
        assert not cockpit.operator.throttle


def test_demands_keep_their_rate_without_ticks_in_between() -> None:
    cockpit = driving_cockpit()
    since = cockpit.now
    assert cockpit.station.rest_period == TICK_PERIOD
    cockpit.run(2.0)
    times = [at for at, _, _ in cockpit.demands(since)]
    assert len(times) == pytest.approx(2.0 / DRIVING_PERIOD, abs=1)
    assert max(later - earlier for earlier, later in pairwise(times)) <= DRIVING_PERIOD + STEP


def test_mode_change_blocks_and_frees_keys_before_the_next_tick() -> None:
    cockpit = driving_cockpit()
    cockpit.vehicle.mode = Mode.AUTO
    cockpit.vehicle.beat()
    cockpit.run(3 * STEP)
    assert cockpit.operator.gate_reason == "mode AUTO"
    assert not cockpit.operator.throttle
    cockpit.vehicle.mode = Mode.MANUAL
    cockpit.vehicle.beat()
    cockpit.run(3 * STEP)
    cockpit.do(DriveKeyDown(key="j", throttle=0, steering=-1))
    cockpit.run(NEUTRAL_LEAD + 2 * STEP)
    assert cockpit.operator.steering < 0, "a new key counts as soon as the neutral lead has passed"


def test_a_repeat_of_a_held_key_extends_its_hold_only() -> None:
    cockpit = armed_cockpit()
    cockpit.run(0.5)
    station = cockpit.station
    assert not station.prolong_key(FORWARD, cockpit.now), "it is not held yet"
    cockpit.do(FORWARD)
    cockpit.run(0.3)
    for _ in range(60):
        assert station.prolong_key(FORWARD, cockpit.now)
        assert not station.messages_to_send()
        cockpit.run(0.03)
    assert cockpit.operator.throttle
    bound = station.operator.sticks.changes_at(cockpit.now)
    assert bound is not None
    cockpit.run(bound - cockpit.now + STEP)
    assert not cockpit.operator.throttle


@pytest.mark.parametrize(
    "other",
    [
        DriveKeyDown(key="j", throttle=0, steering=-1),
        DriveKeyDown(key="i", throttle=-1, steering=0),
        DriveKeyDown(key="i", throttle=1, steering=0, repeat=True),
    ],
    ids=["another key", "another direction", "the proof that releases are reported"],
)
def test_a_change_beyond_the_hold_is_an_intent_like_any_other(other: DriveKeyDown) -> None:
    cockpit = armed_cockpit()
    cockpit.run(0.5)
    cockpit.do(FORWARD)
    cockpit.run(0.1)
    assert cockpit.station.prolong_key(FORWARD, cockpit.now)
    assert not cockpit.station.prolong_key(other, cockpit.now)


def test_a_repeat_holds_nothing_on_once_the_lease_has_run_out() -> None:
    cockpit = driving_cockpit()
    assert cockpit.station.prolong_key(FORWARD, cockpit.now)
    cockpit.leasing = False
    late = cockpit.now + LEASE_TIMEOUT + 0.2
    assert not cockpit.station.prolong_key(FORWARD, late), "as after a freeze: intents come first"
    cockpit.run(0.6)
    assert not cockpit.operator.throttle
