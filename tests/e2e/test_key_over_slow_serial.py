"""Keys do not wait behind a parameter list on a serial line, with both real programs.

A queue before the demands would be an error and not slowness: the list alone takes more than a second of wire time at
57600 baud, and a key behind it would take as long in each round. A late machine delays some rounds, so the best of
them counts, and its bound is far above the time that a key takes (the benchmark measures that: `python -m
tests.benchmarks --only serial_key`).
"""

from __future__ import annotations

import random
from itertools import chain
from math import inf
from statistics import median

import pytest

from tests.benchmarks.figures import BenchmarkError
from tests.benchmarks.serial_key import SLOW, Seen, Wired, wired
from tests.e2e.programs import PATIENT_LOOP

pytestmark = pytest.mark.e2e

KEYS = 9
ROUNDS = 6
"""Rounds at most; one is enough on an idle machine."""
QUEUED = 500.0
"""ms: half of the time that a key behind the list would take at least."""
FULL = 45.0
"""% of the wire from the vehicle that must be in use; telemetry alone takes 37."""


@pytest.mark.slow
def test_a_key_does_not_wait_behind_a_parameter_list() -> None:
    medians: list[float] = []
    chance = random.Random(1)
    with wired(SLOW, "--param", PATIENT_LOOP) as pair:
        while min(medians, default=inf) > QUEUED and len(medians) < ROUNDS:
            medians.append(median_of_a_round(pair, chance))
    assert min(medians) <= QUEUED, medians


def median_of_a_round(pair: Wired, chance: random.Random) -> float:
    """ms from key to motor while the list flows; infinite if a key was lost or a late machine took all of them."""
    before, beside = Seen(), Seen()
    try:
        pair.measure(before, 1, chance)  # then the second station starts its requests
        pair.measure(beside, KEYS, chance)
    except BenchmarkError:
        return inf
    assert beside.down[0] > FULL, "the parameter list did not flow"
    return inf if beside.keys.lost else median(chain(*beside.keys.latencies))
