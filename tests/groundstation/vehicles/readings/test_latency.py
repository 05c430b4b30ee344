"""Key-to-motor latency out of packet sequences and the vehicle's reports."""

from __future__ import annotations

import pytest

from groundstation.vehicles.readings.key_to_motor import KeyTimings
from groundstation.vehicles.readings.latency import LatencyMeter, SentDemand


def test_latency_counts_only_first_report_on_a_changed_demand() -> None:
    meter = LatencyMeter(KeyTimings())
    meter.record_sent(7, SentDemand(1.0, 1.0))
    meter.record_applied(6, 1.01, 0.0)
    assert meter.latest is None
    meter.record_applied(7, 1.05, 0.03)
    assert meter.latest == pytest.approx(0.02)
    meter.record_applied(7, 1.22, 0.0)
    assert meter.latest == pytest.approx(0.02)


def test_a_change_and_its_copies_are_one_measurement() -> None:
    meter = LatencyMeter(KeyTimings())
    meter.record_sent(7, SentDemand(made=1.0, sent=1.0))
    meter.record_sent(8, SentDemand(made=1.0, sent=1.003))
    meter.record_sent(9, SentDemand(made=1.004, sent=1.004))
    meter.record_applied(7, 1.02, 0.0)
    meter.record_applied(8, 1.05, 0.0)
    assert meter.reports == 1
    assert meter.latest == pytest.approx(0.02)
    meter.record_applied(9, 1.014, 0.0)
    assert meter.reports == 2
    assert meter.latest == pytest.approx(0.01)


def test_a_reused_sequence_number_is_ignored() -> None:
    meter = LatencyMeter(KeyTimings())
    meter.record_sent(7, SentDemand(1.0, 1.0))
    meter.record_applied(7, 20.0, 0.0)
    assert meter.latest is None


def test_the_memory_is_bounded() -> None:
    meter = LatencyMeter(KeyTimings())
    for number in range(1000):
        meter.record_sent(number & 0xFF, SentDemand(float(number), float(number)))
    assert len(meter._sent) == 64


def test_the_parts_of_the_way_add_up() -> None:
    """2 ms from the key until it was sent, 20 ms there and back, and the motors obeyed within 6 ms of its arrival."""
    timings = KeyTimings()
    meter = LatencyMeter(timings)
    meter.record_sent(7, SentDemand(made=1.001, sent=1.002, key=0.002))
    meter.record_applied(7, 1.027, 0.005)
    view = timings.build_view()
    parts = (view.key_sent.newest, view.sent_heard.newest, view.heard_motor.newest, view.total.newest)
    assert parts == pytest.approx((0.002, 0.010, 0.006, 0.018))


def test_a_demand_that_no_key_made_has_no_key_time() -> None:
    timings = KeyTimings()
    meter = LatencyMeter(timings)
    meter.record_sent(7, SentDemand(1.0, 1.0))
    meter.record_applied(7, 1.02, 0.0)
    view = timings.build_view()
    assert (view.key_sent.newest, view.total.newest) == (None, None)
    assert view.sent_heard.newest == pytest.approx(0.01)


def test_one_slow_press_of_a_hundred_is_the_p99() -> None:
    timings = KeyTimings()
    for number in range(200):
        timings.add(0.001, 0.5 if number in (50, 60, 70) else 0.01, 0.002)
    assert timings.build_view().sent_heard.newest == 0.01
    assert timings.build_view().sent_heard.p99 == 0.5
    for _ in range(200):
        timings.add(0.001, 0.01, 0.002)
    assert timings.build_view().sent_heard.p99 == 0.01, "the slow ones are forgotten"
