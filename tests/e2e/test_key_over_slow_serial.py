"""Keys reach the motors at once over a serial line full of a parameter list, with both real programs.

This is the only test of a latency. A queue before the demands would be an error and not slowness: a parameter list
alone takes more than a second of wire time at 57600 baud. The bound is on the median of several keys in the best of
some rounds, in which none may be lost: a queue would be there in each round, other load of the machine is not. The
benchmark measures p99 (`python -m tests.benchmarks --only serial_key`).
"""

from __future__ import annotations

import random
from itertools import chain
from math import inf
from statistics import median

import pytest

from tests.benchmarks.serial_key import SLOW, SOFTWARE, Seen, wire_time, wired
from tests.e2e.programs import PATIENT_LOOP

pytestmark = pytest.mark.e2e

KEYS = 9
ROUNDS = 6
"""Rounds at most; one is enough on an idle machine."""
FULL = 45.0
"""% of the wire from the vehicle that must be in use; telemetry alone takes 37."""


@pytest.mark.slow
def test_a_key_needs_its_wire_time_and_30_ms_among_parameters() -> None:
    medians: list[float] = []
    chance = random.Random(1)
    with wired(SLOW, "--param", PATIENT_LOOP) as pair:
        while not medians or (min(medians) > wire_time(SLOW) + SOFTWARE and len(medians) < ROUNDS):
            before, beside = Seen(), Seen()
            pair.measure(before, 1, chance)  # then the second station starts its requests
            pair.measure(beside, KEYS, chance)
            assert beside.down[0] > FULL, "the parameter list did not flow"
            medians.append(inf if beside.keys.lost else median(chain(*beside.keys.latencies)))
    assert min(medians) <= wire_time(SLOW) + SOFTWARE, medians
