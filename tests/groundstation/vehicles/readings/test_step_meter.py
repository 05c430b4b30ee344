"""The upper bound of the latency of a vehicle that reports its outputs a few times a second."""

from __future__ import annotations

import pytest

from groundstation.vehicles.readings.key_to_motor import KeyTimings
from groundstation.vehicles.readings.latency import SentDemand
from groundstation.vehicles.readings.step_meter import StepMeter

STILL, MOVING = (1500.0, 1500.0), (1500.0, 1700.0)


def steady(until: float) -> tuple[StepMeter, KeyTimings]:
    timings = KeyTimings()
    meter = StepMeter(timings)
    for tenth in range(round(until * 10) + 1):
        meter.record_outputs(STILL, 0.02, tenth / 10)
    return meter, timings


def test_it_is_the_time_to_the_first_report_with_other_outputs() -> None:
    meter, timings = steady(1.0)
    meter.record_sent(SentDemand(1.01, 1.01, key=0.003))
    meter.record_outputs(STILL, 0.02, 1.05)
    meter.record_outputs(MOVING, 0.02, 1.15)
    view = timings.build_view()
    assert view.sent_heard.newest == pytest.approx(0.01)
    assert view.heard_motor.newest == pytest.approx(0.13)
    assert view.total.newest == pytest.approx(0.143)


def test_outputs_that_still_follow_earlier_demand_do_not_answer() -> None:
    meter, timings = steady(1.0)
    meter.record_outputs(MOVING, 0.02, 1.1)
    meter.record_sent(SentDemand(1.2, 1.2, key=0.0))
    meter.record_outputs((1500.0, 1800.0), 0.02, 1.21)
    assert timings.build_view().total.newest is None


def test_a_demand_that_changes_nothing_is_forgotten() -> None:
    meter, timings = steady(1.0)
    meter.record_sent(SentDemand(1.0, 1.0, key=0.0))
    meter.record_outputs(MOVING, 0.02, 4.0)
    assert timings.build_view().total.newest is None


def test_of_two_demands_the_first_one_counts() -> None:
    meter, timings = steady(1.0)
    meter.record_sent(SentDemand(1.0, 1.0, key=0.0))
    meter.record_sent(SentDemand(1.1, 1.1, key=0.0))
    meter.record_outputs(MOVING, 0.02, 1.2)
    assert timings.build_view().total.newest == pytest.approx(0.2)


def test_noise_is_no_answer_and_a_slow_change_is_one() -> None:
    meter, timings = steady(1.0)
    meter.record_sent(SentDemand(1.0, 1.0, key=0.0))
    meter.record_outputs((1500.0, 1503.0), 0.02, 1.1)
    assert timings.build_view().total.newest is None
    meter.record_outputs((1500.0, 1512.0), 0.02, 1.2)
    meter.record_outputs((1500.0, 1521.0), 0.02, 1.3)
    assert timings.build_view().total.newest == pytest.approx(0.3)


def test_without_a_round_trip_only_the_whole_way_is_known() -> None:
    meter, timings = steady(1.0)
    meter.record_sent(SentDemand(1.0, 1.0, key=0.002))
    meter.record_outputs(MOVING, None, 1.2)
    view = timings.build_view()
    assert (view.sent_heard.newest, view.heard_motor.newest) == (None, None)
    assert view.total.newest == pytest.approx(0.202)
