"""Key-to-motor latency out of packet sequences and the vehicle's reports."""

from __future__ import annotations

import pytest

from groundstation.vehicles.latency import LatencyMeter


def test_latency_counts_the_first_report_on_a_changed_demand_only() -> None:
    meter = LatencyMeter()
    meter.record_sent(7, 1.0)
    meter.record_applied(6, 1.01, 0.0)
    assert meter.latest is None
    meter.record_applied(7, 1.05, 0.03)
    assert meter.latest == pytest.approx(0.02)
    meter.record_applied(7, 1.22, 0.0)
    assert meter.latest == pytest.approx(0.02)


def test_a_reused_sequence_number_is_ignored() -> None:
    meter = LatencyMeter()
    meter.record_sent(7, 1.0)
    meter.record_applied(7, 20.0, 0.0)
    assert meter.latest is None


def test_the_memory_is_bounded() -> None:
    meter = LatencyMeter()
    for number in range(1000):
        meter.record_sent(number & 0xFF, float(number))
    assert len(meter._sent) == 64
