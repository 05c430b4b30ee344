"""The record of where the simulated rover really is."""

from __future__ import annotations

import math

import pytest

from vehicle.sim.body import SimulatedBody
from vehicle.sim.truth import RecordedBody


def test_the_truth_is_sent_at_10_hz_and_leaves_readings_alone() -> None:
    lines: list[str] = []
    watched, alone = (SimulatedBody(lambda: (0.5, 0.5), seed=3) for _ in range(2))
    body = RecordedBody(watched, lines.append, lambda: 7)
    for cycle in range(101):
        assert body.read(cycle / 50) == alone.read(cycle / 50)
    rows = [[float(word) for word in line.split()] for line in lines]
    assert 16 <= len(rows) <= 21
    assert rows[-1][0] == 7
    assert rows[-1][1:] == pytest.approx((alone.motion.north, 0.0, 0.0, alone.motion.speed), abs=0.1)
    assert alone.motion.north > 1.0
    assert all(map(math.isfinite, rows[0]))
